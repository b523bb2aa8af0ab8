// An argument of a wrong type is a TypeError that names the expected type, any number of times, and the module
// continues to work.
import assert from "node:assert/strict";
import test from "node:test";
import { Arm, CollisionModel, framePlacement, MotionCapture, placement, Problem, Rig, Robot, Scene, tasks, World } from "kinopt";
import { panda, text } from "./panda.js";

const robot = panda();
const arm = new Arm(robot, "base", "flange");
const start = [0, -0.4, 0, -2, 0, 1.6, 0.8];
const target = arm.baseFromTool(start);
target[14] += 0.1;
const urdf = text("franka_panda.urdf");
const { clip } = MotionCapture.fromBytes(new TextEncoder().encode(text("captures/steps.bvh")), "steps.bvh");
const shapes = CollisionModel.ofRobot(robot);
const endless = [];
endless.length = 1e9;

const WRONG = {
    "no text": [() => Robot.fromUrdf(), /text is missing, expected a string/],
    "a number for a text": [() => Robot.fromUrdf(5), /text is a number, expected a string/],
    "bytes for a text": [() => Robot.fromUrdf(new Uint8Array(4)), /text is of Uint8Array, expected a string/],
    "a number for a file's name": [() => Robot.fromUrdf(urdf, 5), /name is a number, expected a string/],
    "a number for a frame": [() => new Arm(robot, "base", 5), /tip is a number, expected a string/],
    "no frame": [() => new Arm(robot, "base"), /tip is missing/],
    "no robot": [() => new Arm(), /robot is missing, expected a Robot/],
    "another class": [() => new Arm(arm, "base", "flange"), /robot is of Arm, expected a Robot/],
    "a number for a frame's name": [() => framePlacement(robot.model, 5, start), /frame is a number/],
    "true for a text": [() => World.fromJson(true), /text is a boolean/],
    "a length without numbers": [() => arm.solve({ length: 1e9 }), /target is of Object, expected a list of numbers/],
    "a length below 0": [() => arm.solve({ length: -1 }), /target is of Object/],
    "an endless list": [() => arm.solve(endless), /target\[0\] is missing, expected a number/],
    "a text among numbers": [() => arm.baseFromTool(["0", 0, 0, 0, 0, 0, 0]), /q\[0\] is a string, expected a number/],
    "large whole numbers": [() => arm.baseFromTool(new BigInt64Array(7)), /q is of BigInt64Array/],
    "no target": [() => arm.solve(), /target is missing, expected a list of numbers/],
    "a length without bytes": [() => Scene.fromBytes({ length: 1e10 }), /data is of Object, expected a Uint8Array/],
    "a buffer": [() => Scene.fromBytes(new ArrayBuffer(8)), /data is of ArrayBuffer, expected a Uint8Array/],
    "a text for bytes": [() => Rig.parse("{}"), /json is a string, expected a Uint8Array/],
    "a number for bytes": [() => MotionCapture.fromBytes(5), /data is a number/],
    "no time": [() => clip.sample(NaN), /seconds is NaN, expected a number/],
    "no list of frames": [() => new Problem(robot.model, tasks.point("flange", [0, 0, 0])), /tasks is of Object, expected an array/],
    "names that are none": [() => Problem.keepingClear(robot.model, [], shapes, "World", 0.1), /world is a string, expected a World/],
    "two numbers for a place": [() => placement([1, 2]), /position\[2\] is undefined: expected three finite numbers/],
    "no number for a place": [() => placement([NaN, 0, 0]), /position\[0\] is NaN/],
    "letters for a place": [() => placement("abc"), /position\[0\] is a/],
};

for (const [what, [wrong, message]] of Object.entries(WRONG)) {
    test(`${what}: an error a thousand times`, () => {
        const expected = arm.solve(target, start).q;
        for (let k = 0; k < 1000; k += 1) assert.throws(wrong, (error) => error instanceof TypeError && message.test(error.message));
        assert.deepEqual(arm.solve(target, start).q, expected);
        assert.deepEqual(new Arm(Robot.fromUrdf(urdf), "base", "flange").solve(target, start).q, expected);
    });
}

test("a too large array is a RangeError, any number of times", () => {
    const large = new Float64Array(2 ** 28);
    const expected = arm.solve(target, start).q;
    for (let k = 0; k < 1000; k += 1) assert.throws(() => arm.solve(large, start), (error) => error instanceof RangeError && /2147483648 bytes exceed the memory/.test(error.message));
    assert.deepEqual(arm.solve(target, start).q, expected);
});

test("a wrong result of a file reader is an error", () => {
    const json = new TextEncoder().encode(text("humanoid/humanoid.json"));
    assert.throws(() => Rig.parse(json, "humanoid.json", () => "ply"), /humanoid\.ply.*Uint8Array/);
    assert.throws(() => Rig.parse(json, "humanoid.json", () => 1e10), /humanoid\.ply.*Uint8Array/);
    assert.throws(() => Rig.parse(json, "humanoid.json"), /humanoid\.ply.*not given with the file that refers to it/);
});

test("errors use the option names of JavaScript", () => {
    assert.throws(() => new Arm(robot, "base", "flange", { positionTolerance: -1 }), /option positionTolerance is -1/);
    assert.throws(() => new Arm(robot, "base", "flange", { jointWeights: [1] }), /jointWeights/);
    assert.throws(() => new Arm(robot, "base", "flange", { jointWeights: { length: 1e9 } }), /jointWeights must be a list of numbers/);
    assert.throws(() => new Arm(robot, "base", "flange", 5), /options of an arm must be an object/);
});
