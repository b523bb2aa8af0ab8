// Any joint, pins, keys, both skinning methods, and the clip.
import assert from "node:assert/strict";
import test, { after, before } from "node:test";
import { skip } from "./browser.js";
import { seen, settled, visiting } from "./visit.js";

const { opened, begin, end } = visiting();
before(begin);
after(end);

test("joints, pins, keys, skinning and clip", { skip }, async () => {
    const { page, consoleMessages } = await opened();
    const at = (name) => page.evaluate((name) => kinoptPage.view.place(name).toArray(), name);
    const canvas = page.locator("#stage");
    await canvas.focus();
    await page.keyboard.press("j");
    const name = await page.evaluate(() => kinoptPage.grabbed);
    assert.ok(name);
    const grabbed = await seen(page, "right_hand");
    await page.mouse.click(grabbed.x, grabbed.y);
    assert.equal(await page.evaluate(() => kinoptPage.grabbed), "right_hand");
    const before = await at("right_hand");
    await canvas.focus();
    for (let k = 0; k < 5; k += 1) await page.keyboard.press("ArrowDown");
    await settled(page);
    const after = await at("right_hand");
    assert.ok(after[2] < before[2] - 0.01, `${before} to ${after}`);
    const pins = () => page.evaluate(() => [...kinoptPage.pins]);
    assert.deepEqual(await pins(), ["left_foot", "right_foot"]);
    await page.locator("#pin").click();
    assert.ok((await pins()).includes("right_hand"));
    await page.locator("#pin").click();
    assert.ok(!(await pins()).includes("right_hand"));
    const positions = () => page.evaluate(() => [...kinoptPage.view.geometry.attributes.position.array]);
    const linear = await positions();
    await page.locator("#skin").click();
    await settled(page);
    const dual = await positions();
    assert.ok(dual.some((value, k) => Math.abs(value - linear[k]) > 1e-4));
    await page.locator("#play").click();
    await page.waitForFunction(() => kinoptPage.playback.seconds > 0.3);
    const played = await positions();
    await page.locator("#play").click();
    assert.ok(played.some((value, k) => Math.abs(value - dual[k]) > 1e-3));
    await page.locator("#rest").click();
    await settled(page);
    assert.deepEqual(consoleMessages, []);
    await page.close();
});
