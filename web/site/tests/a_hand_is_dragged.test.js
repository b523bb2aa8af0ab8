// A hand is dragged along 300 points at 60 frames a second; pinned tips stay.
import assert from "node:assert/strict";
import test, { after, before } from "node:test";
import { skip } from "./browser.js";
import { pictured, seen, settled, visiting } from "./visit.js";

const { opened, begin, end } = visiting();
before(begin);
after(end);

test("a hand is dragged along 300 points", { skip }, async () => {
    const { page, consoleMessages } = await opened();
    const hand = await seen(page, "left_hand");
    const foot = await page.evaluate(() => kinoptPage.view.place("left_foot").toArray());
    await page.mouse.move(hand.x, hand.y);
    await page.mouse.down();
    for (let k = 1; k <= 300; k += 1) {
        const turn = (2 * Math.PI * k) / 300;
        await page.mouse.move(hand.x - 60 * Math.sin(turn), hand.y - 50 * (1 - Math.cos(turn)));
        await page.waitForTimeout(1000 / 60);
        if (k === 120) await pictured(page, "web-humanoid.png");
    }
    await page.mouse.up();
    await settled(page);
    const frames = await page.evaluate(() => kinoptPage.frames);
    assert.ok(frames.length > 30, `${frames.length} frames`);
    const back = await seen(page, "left_hand");
    assert.ok(Math.hypot(back.x - hand.x, back.y - hand.y) < 4, "the hand returns with the mouse");
    const held = await page.evaluate(() => kinoptPage.view.place("left_foot").toArray());
    held.forEach((value, k) => assert.ok(Math.abs(value - foot[k]) < 1e-3, "the pinned foot stays"));
    const of = (what) => frames.map(what).sort((a, b) => a - b);
    const both = of(({ solved, posed }) => solved + posed);
    const quantile = (share) => both[Math.floor(share * (both.length - 1))].toFixed(2);
    console.log(`${frames.length} frames: solving and skin ${quantile(0.5)} ms in the median, ${quantile(0.95)} at the 95th percentile`);
    assert.deepEqual(consoleMessages, []);
    await page.close();
});
