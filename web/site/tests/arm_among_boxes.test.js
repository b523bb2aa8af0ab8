// An arm's tool follows among boxes and touches none.
import assert from "node:assert/strict";
import test, { after, before } from "node:test";
import { skip } from "./browser.js";
import { pictured, seen, settled, visiting } from "./visit.js";

const { opened, begin, end } = visiting();
before(begin);
after(end);

test("an arm's tool follows among boxes without contact", { skip }, async () => {
    const { page, consoleMessages } = await opened();
    await page.locator('[data-open="panda"]').click();
    await page.waitForFunction(() => kinoptPage.opened?.kind === "robot", undefined, { timeout: 60_000 });
    await settled(page);
    const tool = await seen(page, "flange");
    await page.mouse.move(tool.x, tool.y);
    await page.mouse.down();
    for (let k = 1; k <= 90; k += 1) {
        await page.mouse.move(tool.x + 0.8 * k, tool.y + 1.5 * k);
        await page.waitForTimeout(1000 / 60);
    }
    await page.mouse.up();
    await settled(page);
    await pictured(page, "web-panda.png");
    const low = await page.evaluate(() => kinoptPage.view.place("flange").z);
    assert.ok(low > 0.14, `the flange stops above the table, at ${low} m`);
    const frames = await page.evaluate(() => kinoptPage.frames.map(({ solved }) => solved).sort((a, b) => a - b));
    console.log(`${frames.length} steps: ${frames[frames.length >> 1].toFixed(2)} ms in the median`);
    // It does not penetrate the ground next to the table either.
    const floor = await page.evaluate(() => kinoptPage.opened.floor);
    const at = await seen(page, "flange");
    await page.mouse.move(at.x, at.y);
    await page.mouse.down();
    for (const [right, down] of [[-160, -80], [-260, 400]]) await page.mouse.move(at.x + right, at.y + down, { steps: 60 });
    await page.mouse.up();
    await settled(page);
    const [handHeight, targetHeight] = await page.evaluate(() => [kinoptPage.view.place("flange").z, kinoptPage.target.z]);
    assert.ok(targetHeight < floor && handHeight > floor, `the hand at ${targetHeight} m, the flange at ${handHeight} m`);
    assert.deepEqual(consoleMessages, []);
    await page.close();
});
