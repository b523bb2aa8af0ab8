// An invalid file is an exception with the library's message: the file, the place in it, and the fault.
import assert from "node:assert/strict";
import test from "node:test";
import { MotionCapture, Rig, Robot, Scene, World } from "kinopt";
import { text } from "./panda.js";

const bytes = (string) => new TextEncoder().encode(string);

test("errors of damaged files name the place", () => {
    const urdf = text("franka_panda.urdf");
    assert.throws(() => Robot.fromUrdf(urdf.slice(0, 900), "cut.urdf"), /cut\.urdf/);
    assert.throws(() => Robot.fromUrdf(urdf.replace('type="revolute"', 'type="rotating"'), "odd.urdf"), /odd\.urdf.*rotating/s);
    assert.throws(() => Rig.parse(bytes("{"), "rig.json"), /rig\.json/);
    assert.throws(() => Scene.fromBytes(bytes("glTF"), "scene.glb"), /scene\.glb/);
    assert.throws(() => MotionCapture.fromBytes(bytes("HIERARCHY\nROOT hips\nFOOT"), "walk.bvh"), /walk\.bvh.*3/s);
    assert.throws(() => World.fromJson('{"obstacles": 3}', "table.json"), /table\.json/);
});

test("referenced files are opened; exceptions propagate", () => {
    const rig = text("humanoid/humanoid.json");
    assert.throws(() => Rig.parse(bytes(rig), "humanoid.json"), /humanoid\.ply/);
    assert.throws(
        () => Rig.parse(bytes(rig), "humanoid.json", () => { throw new RangeError("offline"); }),
        (error) => error instanceof RangeError && error.message === "offline",
    );
});

test("exceptions are errors, and the module still works", () => {
    for (let k = 0; k < 100; k += 1) assert.throws(() => Robot.fromUrdf("<robot"), Error);
    assert.equal(Robot.fromUrdf(text("franka_panda.urdf")).chain("base", "flange").length, 7);
});
