// A hand is dragged during playback, pinned there, and returns to the clip.
import assert from "node:assert/strict";
import test, { after, before } from "node:test";
import { skip } from "./browser.js";
import { colour, pictured, seen, settled, status, visiting } from "./visit.js";

const [BLUE, ORANGE] = [0x1f6fb2, 0xe08a1e];
const { opened, begin, end } = visiting();
before(begin);
after(end);

test("a hand is dragged and pinned during playback, then returns", { skip }, async () => {
    const { page, consoleMessages } = await opened();
    const at = (name) => page.evaluate((name) => kinoptPage.view.place(name).toArray(), name);
    const away = (a, b) => Math.hypot(...a.map((value, k) => value - b[k]));
    const hand = await seen(page, "left_hand");
    const begun = await at("left_hand");
    await page.locator("#play").click();
    await page.waitForFunction(() => kinoptPage.playback.running);
    await page.mouse.move(hand.x, hand.y);
    await page.mouse.down();
    for (let k = 1; k <= 60; k += 1) {
        await page.mouse.move(hand.x - k, hand.y - 2 * k);
        await page.waitForTimeout(1000 / 60);
        if (k === 50) await pictured(page, "web-over-clip.png");
    }
    const target = await page.evaluate(() => kinoptPage.target.toArray());
    await page.waitForFunction((target) => kinoptPage.view.place("left_hand").toArray().every((value, k) => Math.abs(value - target[k]) < 0.01), target);
    // The other hand moves from frame to frame.
    const waving = [];
    for (let k = 0; k < 8; k += 1) {
        waving.push(await at("right_hand"));
        await page.waitForTimeout(150);
    }
    assert.ok(Math.max(...waving.map((position) => away(position, waving[0]))) > 0.03, "the clip continues");
    await page.locator("#stage").focus();
    assert.equal(await colour(page, "left_hand"), ORANGE);
    await page.keyboard.press("p");
    await page.mouse.up();
    assert.equal(await colour(page, "left_hand"), BLUE, "a pinned handle is blue, also while it is grabbed");
    await page.waitForTimeout(700);
    assert.ok(away(await at("left_hand"), target) < 0.01, "a pinned hand stays");
    await page.keyboard.press("p");
    await page.waitForFunction((begun) => Math.hypot(...kinoptPage.view.place("left_hand").toArray().map((value, k) => value - begun[k])) < 0.05, begun);
    const frames = await page.evaluate(() => kinoptPage.frames.map(({ solved }) => solved).sort((a, b) => a - b));
    console.log(`${frames.length} frames over the clip: ${frames[frames.length >> 1].toFixed(2)} ms in the median`);
    // The keyboard holds too.
    await page.keyboard.press("ArrowUp");
    assert.ok(await page.evaluate(() => kinoptPage.nudged && kinoptPage.grabbed === "left_hand"));
    await page.keyboard.press("Escape");
    assert.equal(await page.evaluate(() => kinoptPage.grabbed), undefined);
    await page.locator("#play").click();
    assert.deepEqual(consoleMessages, []);
    await page.close();
});

test("playback reports the pose that it replaces", { skip }, async () => {
    const { page, consoleMessages } = await opened();
    const hand = await seen(page, "left_hand");
    await page.mouse.click(hand.x, hand.y);
    await settled(page);
    await page.locator("#play").click();
    await page.waitForFunction(() => kinoptPage.playback.seconds > 0.1);
    assert.equal(await status(page), "", "nothing was dragged");
    await page.locator("#rest").click();
    await page.mouse.move(hand.x, hand.y);
    await page.mouse.down();
    await page.mouse.move(hand.x - 30, hand.y - 60, { steps: 10 });
    await page.mouse.up();
    await settled(page);
    await page.locator("#play").click();
    await page.waitForFunction(() => kinoptPage.playback.seconds > 0.5);
    assert.match(await status(page), /replaces the dragged pose/);
    // Until a handle is grabbed, or playback stops.
    await page.locator("#play").click();
    assert.equal(await status(page), "");
    assert.deepEqual(consoleMessages, []);
    await page.close();
});
