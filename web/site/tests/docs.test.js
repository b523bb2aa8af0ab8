// The documentation in a browser. Nothing is wider than a small screen, and no table wider than a desktop's. A language
// choice applies to all pages, the search finds sections, the console has no messages, and pages are readable without
// scripts.
import assert from "node:assert/strict";
import test, { after, before } from "node:test";
import { contents, pages } from "../docs/contents.js";
import { skip, started } from "./browser.js";

const PHONE = { viewport: { width: 360, height: 640 }, hasTouch: true, isMobile: true };
let site;

before(async () => {
    if (!skip) site = await started();
});
after(() => site?.close());

async function opened(address, options = {}) {
    const context = await site.browser.newContext({ viewport: { width: 1300, height: 800 }, ...options });
    const page = await context.newPage();
    const consoleMessages = [];
    page.on("console", (message) => consoleMessages.push(message.text()));
    page.on("pageerror", (error) => consoleMessages.push(String(error)));
    await page.goto(site.address + address);
    return { page, consoleMessages, context };
}

test("pages fit a small screen without console messages", { skip }, async () => {
    const { page, consoleMessages, context } = await opened("docs/index.html", PHONE);
    for (const { address } of pages(contents()).values()) {
        await page.goto(site.address + address, { waitUntil: "domcontentloaded" });
        const wide = await page.evaluate(() => document.documentElement.scrollWidth);
        assert.ok(wide <= 360, `${address} is ${wide} wide`);
    }
    assert.deepEqual(consoleMessages, []);
    await context.close();
});

test("every table fits a desktop screen", { skip }, async () => {
    const { page, context } = await opened("docs/index.html", { viewport: { width: 1280, height: 800 } });
    for (const { address } of pages(contents()).values()) {
        await page.goto(site.address + address, { waitUntil: "domcontentloaded" });
        const wide = await page.locator(".table").evaluateAll((tables) => tables.filter((table) => table.scrollWidth > table.clientWidth + 1).map((table) => table.innerText.slice(0, 60)));
        assert.deepEqual(wide, [], address);
    }
    await context.close();
});

test("a language is selected for all groups", { skip }, async () => {
    const { page, consoleMessages, context } = await opened("docs/guide/arms.html");
    const shown = () => page.locator(".languages section:visible").evaluateAll((parts) => parts.map((part) => part.dataset.language));
    assert.deepEqual(new Set(await shown()), new Set(["Rust"]));
    await page.locator('[role="tab"]', { hasText: "Python" }).first().click();
    assert.deepEqual(new Set(await shown()), new Set(["Python"]));
    await page.keyboard.press("ArrowRight");
    assert.deepEqual(new Set(await shown()), new Set(["JavaScript"]));
    await page.goto(`${site.address}docs/guide/servo.html`);
    assert.ok((await shown()).includes("JavaScript"));
    assert.deepEqual(consoleMessages, []);
    await context.close();
});

test("the search finds a section", { skip }, async () => {
    const { page, consoleMessages, context } = await opened("docs/index.html");
    await page.keyboard.press("/");
    await page.keyboard.type("priority levels");
    await page.locator("#results a").first().waitFor();
    await page.keyboard.press("Enter");
    await page.waitForURL(/priorities\.html/);
    assert.deepEqual(consoleMessages, []);
    await context.close();
});

test("contents open on a small screen, also without scripts", { skip }, async () => {
    const phone = await opened("docs/guide/arms.html", PHONE);
    const entry = phone.page.locator("#contents a", { hasText: "Options" });
    assert.equal(await entry.isVisible(), false);
    await phone.page.locator("#menu").click();
    await entry.click();
    await phone.page.waitForURL(/options\.html/);
    await phone.context.close();
    const plain = await opened("docs/guide/arms.html", { ...PHONE, javaScriptEnabled: false });
    assert.equal(await plain.page.locator(".languages section:visible").count(), await plain.page.locator(".languages section").count());
    assert.ok(await plain.page.locator("#contents a", { hasText: "Options" }).isVisible());
    await plain.context.close();
});
