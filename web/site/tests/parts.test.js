// Parts of the page without a browser: dropped folders, files that stay, handles held during playback.
import assert from "node:assert/strict";
import test from "node:test";
import { dropped, mergeFiles } from "../src/files.js";
import { HeldOverClip } from "../src/held_over_clip.js";
import { Playback } from "../src/playback.js";

const file = (name) => ({ isFile: true, file: (resolve) => resolve({ name }) });
/** A folder whose reader returns two entries at a time; browsers return a hundred. */
const folder = (...entries) => ({
    isDirectory: true,
    createReader() {
        let at = 0;
        return { readEntries: (resolve) => resolve(entries.slice(at, (at += 2))) };
    },
});

test("a folder is dropped with its contents", async () => {
    const items = [folder(file("arm.urdf"), file("a.stl"), folder(file("b.stl"), file("c.dae"), file("d.obj")))];
    const found = await dropped({ items: items.map((entry) => ({ webkitGetAsEntry: () => entry })), files: [] });
    assert.deepEqual(found.map(({ name }) => name).sort(), ["a.stl", "arm.urdf", "b.stl", "c.dae", "d.obj"]);
    const plain = [{ name: "walk.bvh" }];
    assert.deepEqual(await dropped({ items: [{ webkitGetAsEntry: () => file("walk.bvh") }], files: plain }), plain);
});

test("a new capture keeps the robot, a new robot the capture", () => {
    const before = { "nao.urdf": 1, "torso.stl": 2, "steps.bvh": 3 };
    assert.deepEqual(mergeFiles(before, { "mine.bvh": 4 }), { "nao.urdf": 1, "torso.stl": 2, "mine.bvh": 4 });
    assert.deepEqual(mergeFiles(before, { "g1.xml": 5 }), { "g1.xml": 5, "steps.bvh": 3 });
    assert.deepEqual(mergeFiles(before, { "fox.glb": 6 }), { "fox.glb": 6 });
});

test("a released handle returns to the clip without a jump", () => {
    const held = new HeldOverClip();
    const home = [0, 0, 0];
    const frame = 1 / 60;
    assert.ok(!held.active);
    assert.deepEqual(held.targets([["hand", [1, 0, 0]]], frame, () => home).get("hand"), [1, 0, 0]);
    held.ended([0, 0], [0.3, -0.2]);
    let position = 1;
    let angleLeft = 0.3;
    let frames = 0;
    for (; held.active && frames < 1000; frames += 1) {
        const targets = held.targets([], frame, () => home);
        const next = targets.get("hand")?.[0] ?? 0;
        assert.ok(next <= position && position - next < 0.08, `from ${position} to ${next}`);
        position = next;
        const [angle] = held.start([0, 0], frame);
        assert.ok(angle <= angleLeft && angleLeft - angle < 0.03, `from ${angleLeft} to ${angle}`);
        angleLeft = angle;
    }
    assert.ok(position === 0 && angleLeft < 1e-3 && frames > 24 && frames < 240, `${frames} frames`);
    // A handle that is held again is no longer released.
    held.targets([["hand", [1, 0, 0]]], frame, () => home);
    held.targets([], frame, () => home);
    assert.deepEqual(held.targets([["hand", [0.5, 0, 0]]], frame, () => home).get("hand"), [0.5, 0, 0]);
});

test("joints return slower than a drag moves back", () => {
    const held = new HeldOverClip();
    held.targets([["hand", [1, 0, 0]]], 0.1, () => [0, 0, 0]);
    held.ended([0, 0], [1.5, 0.2]);
    const [angle] = held.start([0, 0], 0.1);
    assert.ok(1.5 - angle <= 0.0500001 && angle < 1.5);
});

test("playback stays in the clip and continues from its time", async () => {
    const playback = new Playback();
    playback.begin(true);
    await new Promise((resolve) => setTimeout(resolve, 40));
    const { seconds, passed } = playback.advance(0.02);
    assert.ok(seconds >= 0 && seconds < 0.02 && passed > 0 && passed <= 0.25);
});
