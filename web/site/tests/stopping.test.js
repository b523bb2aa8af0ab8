// A long request is stopped, and the previous model is shown again.
import assert from "node:assert/strict";
import { join } from "node:path";
import test, { after, before } from "node:test";
import { skip } from "./browser.js";
import { seen, settled, visiting } from "./visit.js";

const { opened, begin, end } = visiting();
before(begin);
after(end);

test("a long request is stopped and the model kept", { skip }, async () => {
    const { page, consoleMessages } = await opened();
    await page.evaluate(() => {
        const joints = Array.from({ length: 60 }, (_, k) => `JOINT j${k} {\nOFFSET 0 1 0\nCHANNELS 3 Zrotation Xrotation Yrotation\n`);
        const head = `HIERARCHY\nROOT r {\nOFFSET 0 0 0\nCHANNELS 3 Zrotation Xrotation Yrotation\n${joints.join("")}End Site {\nOFFSET 0 1 0\n}\n`;
        const frames = 80_000;
        const text = `${head}${"}\n".repeat(61)}MOTION\nFrames: ${frames}\nFrame Time: 0.01\n${`${"0.5 ".repeat(183)}\n`.repeat(frames)}`;
        const dataTransfer = new DataTransfer();
        dataTransfer.items.add(new File([text], "long.bvh"));
        dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true }));
    });
    await page.locator("#stop").click();
    await page.waitForFunction(() => document.querySelector("#status").textContent === "Stopped.");
    await page.waitForFunction(() => document.querySelector("#stop").hidden);
    const hand = await seen(page, "left_hand");
    await page.mouse.move(hand.x, hand.y);
    await page.mouse.down();
    await page.mouse.move(hand.x - 30, hand.y + 60, { steps: 20 });
    await page.mouse.up();
    await settled(page);
    const moved = await seen(page, "left_hand");
    assert.ok(Math.hypot(moved.x - hand.x, moved.y - hand.y) > 20);
    assert.deepEqual(consoleMessages, []);
    await page.close();
});
