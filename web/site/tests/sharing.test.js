// The first scene moves until somebody grabs; figures of its frames, the code panel, and a link to a pose.
import assert from "node:assert/strict";
import test, { after, before } from "node:test";
import { skip } from "./browser.js";
import { pictured, seen, settled, status, visiting } from "./visit.js";

const { opened, begin, end } = visiting();
before(begin);
after(end);

const places = (page) => page.evaluate(() => [...kinoptPage.view.places]);
const away = (a, b) => Math.max(...a.map((value, k) => Math.abs(value - b[k])));

test("a scene moves until a handle is grabbed", { skip }, async () => {
    const { page, consoleMessages } = await opened({ reducedMotion: "no-preference" });
    const start = await places(page);
    await page.waitForFunction((start) => kinoptPage.view.places.some((value, k) => Math.abs(value - start[k]) > 0.02), start);
    await page.waitForFunction(() => /µs/.test(document.querySelector("#readout").textContent));
    assert.match(await page.locator("#readout").innerText(), /reached/);
    await pictured(page, "preview.jpg");
    await page.locator("#stage").focus();
    await page.keyboard.press("j");
    await settled(page);
    const still = await places(page);
    await page.waitForTimeout(400);
    assert.deepEqual(await places(page), still);
    await page.keyboard.press("Escape");
    assert.deepEqual(consoleMessages, []);
    await page.close();
});

test("a link opens the pose and the view of another page", { skip }, async () => {
    const { page, consoleMessages } = await opened();
    await page.locator("#show-code").click();
    assert.match(await page.locator("#code code").textContent(), /supportPolygon/);
    assert.equal(await page.locator("#code a").getAttribute("href"), "docs/guide/dragging.html");
    await page.locator("#show-code").click();
    assert.ok(await page.locator("#code").isHidden());
    const hand = await seen(page, "left_hand");
    await page.mouse.move(hand.x, hand.y);
    await page.mouse.down();
    await page.mouse.move(hand.x - 40, hand.y - 90, { steps: 10 });
    await page.mouse.up();
    await settled(page);
    await page.locator("#stage").focus();
    await page.keyboard.press("Escape");
    await page.keyboard.press("ArrowRight");
    await page.locator("#share").click();
    await page.waitForFunction(() => location.hash.includes("scene=humanoid"));
    assert.match(await status(page), /link/);
    const [address, pose, view] = await page.evaluate(() => [location.href, [...kinoptPage.view.places], kinoptPage.stage.view]);
    await page.goto("about:blank");
    await page.goto(address);
    await page.waitForFunction(() => globalThis.kinoptPage?.view);
    assert.ok(away(await places(page), pose) < 1e-5);
    assert.ok(away(await page.evaluate(() => kinoptPage.stage.view), view) < 1e-5);
    assert.equal(await page.evaluate(() => kinoptPage.demo), undefined);
    assert.deepEqual(consoleMessages, []);
    await page.close();
});
