// Each clip of a file can be selected, and plays at once.
import assert from "node:assert/strict";
import test, { after, before } from "node:test";
import { skip } from "./browser.js";
import { file, visiting } from "./visit.js";

const { opened, begin, end } = visiting();
before(begin);
after(end);

/** Two bones, one of which turns in one clip, and rises in another that has no name and is twice as long. */
function twoClips() {
    const numbers = [[0, 1], [0, 2], [0, 0, 0, 1, 0, 0, 1, 0], [0, 1, 0, 0, 3, 0]].map((values) => new Float32Array(values));
    let byteOffset = 0;
    const bufferViews = numbers.map(({ byteLength }) => {
        byteOffset += byteLength;
        return { buffer: 0, byteOffset: byteOffset - byteLength, byteLength };
    });
    const types = ["SCALAR", "SCALAR", "VEC4", "VEC3"];
    const data = Buffer.concat(numbers.map(({ buffer }) => Buffer.from(buffer))).toString("base64");
    const clip = (input, output, path) => ({ samplers: [{ input, output }], channels: [{ sampler: 0, target: { node: 1, path } }] });
    return JSON.stringify({
        asset: { version: "2.0" }, scene: 0, scenes: [{ nodes: [0] }],
        nodes: [{ name: "root", children: [1] }, { name: "tip", translation: [0, 1, 0], children: [2] }, { name: "end", translation: [1, 0, 0] }],
        animations: [{ name: "turn", ...clip(0, 2, "rotation") }, clip(1, 3, "translation")],
        buffers: [{ uri: `data:application/octet-stream;base64,${data}`, byteLength: byteOffset }],
        bufferViews,
        accessors: types.map((type, bufferView) => ({ bufferView, componentType: 5126, count: 2, type, ...(type === "SCALAR" && { min: [0], max: [bufferView + 1] }) })),
    });
}

test("each clip of a file is selected and plays at once", { skip }, async () => {
    const { page, consoleMessages } = await opened();
    const clip = page.locator("#clip");
    assert.ok(await clip.isHidden(), "a rig has one clip");
    await page.locator("#file").setInputFiles([file("two.gltf", twoClips())]);
    await page.waitForFunction(() => kinoptPage.opened.handles.includes("end"));
    assert.deepEqual(await clip.locator("option").allTextContents(), ["turn", "animation/1"]);
    assert.equal(await page.evaluate(() => kinoptPage.opened.seconds), 1);
    await clip.selectOption("animation/1");
    await page.waitForFunction(() => kinoptPage.playback.running && kinoptPage.playback.seconds > 0.5);
    assert.equal(await page.evaluate(() => kinoptPage.opened.seconds), 2);
    const [x, y] = await page.evaluate(() => kinoptPage.view.place("end").toArray());
    assert.ok(y > 1.2 && Math.abs(x - 1) < 1e-6, `it rises without rotation: ${x}, ${y}`);
    await page.locator("#rest").click();
    await page.waitForFunction(() => kinoptPage.view.place("end").y === 1);
    await clip.selectOption("turn");
    await page.waitForFunction(() => kinoptPage.playback.running && kinoptPage.view.place("end").x < 0.9);
    assert.deepEqual(consoleMessages, []);
    await page.close();
});
