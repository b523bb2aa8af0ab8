// A captured motion is retargeted to a robot, within its limits, by a guessed or a given map.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import test from "node:test";
import { CollisionModel, framePlacement, MotionCapture, retarget, retargetClear, RetargetFollower, Robot, World } from "kinopt";
import { model, text } from "./panda.js";

/** Mean direction error of all limbs, degrees. */
const meanAngle = ({ limbs }) => Object.values(limbs).reduce((sum, { mean }, _, all) => sum + mean / all.length, 0);

const turns = "CHANNELS 3 Zrotation Xrotation Yrotation";
/** A chain of joints: names and offsets, centimetres. */
const limb = ([[name, offset], ...rest]) =>
    rest.length === 0
        ? `JOINT ${name} {\nOFFSET ${offset}\n${turns}\nEnd Site {\nOFFSET 0 0 1\n}\n}\n`
        : `JOINT ${name} {\nOFFSET ${offset}\n${turns}\n${limb(rest)}}\n`;
const side = (name, x) => [
    limb([[`${name}UpLeg`, `${10 * x} 0 0`], [`${name}Leg`, "0 -42 0"], [`${name}Foot`, "0 -42 0"]]),
    limb([[`${name}Arm`, `${18 * x} 48 0`], [`${name}ForeArm`, `${28 * x} 0 0`], [`${name}Hand`, `${25 * x} 0 0`]]),
];
/** A subject that nods and sways for a second, centimetres, y up. */
const person = () => {
    const limbs = [limb([["Spine", "0 20 0"], ["Neck", "0 30 0"], ["Head", "0 12 0"]]), ...side("Left", 1), ...side("Right", -1)];
    const frames = Array.from({ length: 31 }, (_, k) => {
        const sway = 5 * Math.sin((2 * Math.PI * k) / 30);
        return [sway, 90, 0, ...Array(48).fill(0).map((_, j) => (j === 4 ? sway : 0))].join(" ");
    });
    return `HIERARCHY\nROOT Hips {\nOFFSET 0 90 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n${limbs.join("")}}\n` +
        `MOTION\nFrames: 31\nFrame Time: 0.0333333\n${frames.join("\n")}\n`;
};

test("a captured motion is retargeted to a NAO", () => {
    const capture = MotionCapture.fromBytes(new TextEncoder().encode(person()), "sway.bvh");
    const robot = Robot.fromUrdf(text("aldebaran_nao.urdf"), "nao.urdf", { baseJoint: "free" });
    const found = retarget(robot, capture.clip);
    const { lower, upper, configurationLen: length } = robot.model;
    assert.equal(found.times.length, 31);
    const q = found.q.slice();
    assert.equal(q.length, 31 * length);
    assert.ok(q.every((value, k) => lower[k % length] <= value && value <= upper[k % length]));
    assert.ok(meanAngle(found.report) < 20, `${meanAngle(found.report)} degrees`);
    // A map without drives is completed by names; one whose drives are empty is invalid.
    const completed = retarget(robot, capture.clip, "{}");
    assert.deepEqual(completed.q, q);
    assert.deepEqual(completed.report.notes, ["the map drives no frame of the target, so drives are guessed from names", ...found.report.notes]);
    assert.throws(() => retarget(robot, capture.clip, '{"drives": {}}'), /drives no frame/);
    assert.throws(() => retarget(robot, capture.clip, undefined, { speed: 2 }), /speed.*fps/s);
});

test("a follower works by frame, a whole motion reports progress", () => {
    const capture = MotionCapture.fromBytes(readFileSync(model("captures/steps.bvh")), "steps.bvh");
    const robot = Robot.fromUrdf(text("aldebaran_nao.urdf"), "nao.urdf", { baseJoint: "free" });
    const { armature, clip } = capture;
    const follower = new RetargetFollower(robot, clip, undefined, { fps: 30, contactSpeed: 0.06 });
    assert.deepEqual(follower.joints, armature.names);
    assert.equal(follower.up, "y");
    assert.equal(JSON.parse(follower.map).drives.LeftFoot.frame ?? JSON.parse(follower.map).drives.LeftFoot, "left_foot");
    const { lower, upper } = robot.model;
    const ankles = [];
    const heights = [];
    for (let frame = 0; frame <= 180; frame += 1) {
        const q = follower.step(armature.places(clip.sample(frame / 30)));
        assert.ok(q.every((value, k) => lower[k] <= value && value <= upper[k]));
        ankles.push(framePlacement(robot.model, "left_foot", q).slice(12, 15));
        heights.push(framePlacement(robot.model, "torso", q)[14]);
    }
    // The left foot is in contact from 2.1 s on, after its steps to the side and back.
    const slip = Math.max(...ankles.slice(70).map((at) => Math.hypot(at[0] - ankles[70][0], at[1] - ankles[70][1])));
    assert.ok(slip < 0.003, `${slip} m`);
    const aside = Math.max(...ankles.map((at) => Math.abs(at[0] - ankles[0][0])));
    assert.ok(aside > 0.04, `${aside} m`);
    assert.ok(Math.min(...heights) < heights[0] - 0.04, "it crouches");
    const progressCalls = [];
    const whole = retarget(robot, clip, undefined, { whole: true, contactSpeed: 0.06, progress: (done, total) => progressCalls.push([done, total]) });
    assert.equal(whole.times.length, 181);
    assert.ok(progressCalls.length > 1 && progressCalls.every(([done, total], k) => total === 181 && done > (progressCalls[k - 1]?.[0] ?? 0)));
    assert.equal(progressCalls.at(-1)[0], 181);
    assert.ok(whole.report.slip < 0.005 && meanAngle(whole.report) < 20);
    const stops = { whole: true, progress: () => { throw new RangeError("enough"); } };
    assert.throws(() => retarget(robot, clip, undefined, stops), (error) => error instanceof RangeError);
    assert.throws(() => follower.step([0, 1, 2]), /places has 3 numbers/);
    assert.throws(() => new RetargetFollower(robot, clip, undefined, { whole: true }), /whole.*fps/s);
});

test("the error of an invalid map names it", () => {
    const capture = MotionCapture.fromBytes(new TextEncoder().encode(person()), "sway.bvh");
    const robot = Robot.fromUrdf(text("aldebaran_nao.urdf"), "nao.urdf", { baseJoint: "free" });
    assert.throws(() => retarget(robot, capture.clip, "{"), /the map: EOF/);
});

test("retargeting avoids a world and reports collisions", () => {
    const capture = MotionCapture.fromBytes(new TextEncoder().encode(person()), "sway.bvh");
    const robot = Robot.fromUrdf(text("aldebaran_nao.urdf"), "nao.urdf", { baseJoint: "free" });
    const shapes = CollisionModel.ofRobot(robot);
    const plain = retarget(robot, capture.clip, undefined, { fps: 10 });
    assert.deepEqual([...plain.report.touching], []);
    const farWorld = new World();
    farWorld.addBox("far", [0.1, 0.1, 0.1], [5, 0, 0]);
    const apart = retargetClear(robot, capture.clip, shapes, farWorld, undefined, { fps: 10, margin: 0.001 });
    assert.deepEqual([...apart.report.touching], []);
    assert.ok(Math.abs(meanAngle(apart.report) - meanAngle(plain.report)) < 2 && apart.report.stride === plain.report.stride && plain.report.stride < 0.005);
    assert.deepEqual(JSON.parse(farWorld.scaled(0.5).toJson()).boxes[0].position, [2.5, 0, 0]);
    assert.throws(() => farWorld.scaled(0), /times/);
    // A collision with an obstacle that the robot holds cannot be avoided.
    const held = World.fromJson('{"boxes": [{"name": "crate", "size": [1, 1, 1], "attached": "torso"}]}');
    assert.equal(retargetClear(robot, capture.clip, shapes, held, undefined, { fps: 10 }).report.touching.length, plain.times.length);
    const follower = RetargetFollower.clear(robot, capture.clip, shapes, farWorld, undefined, { fps: 10 });
    const q = follower.step(capture.armature.places(capture.clip.sample(0)));
    assert.ok(q.every((value, k) => robot.model.lower[k] <= value && value <= robot.model.upper[k]));
    assert.throws(() => retargetClear(robot, capture.clip, shapes, farWorld, undefined, { margin: -1 }), /margin/);
    assert.throws(() => retarget(robot, capture.clip, undefined, { margin: 0 }), /margin.*fps/s);
});
