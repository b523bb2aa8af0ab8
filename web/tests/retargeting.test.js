// A captured movement comes onto a robot, within its limits, by a map that is guessed or given.
import assert from "node:assert/strict";
import test from "node:test";
import { MotionCapture, retarget, Robot } from "kinopt";
import { text } from "./panda.js";

const turns = "CHANNELS 3 Zrotation Xrotation Yrotation";
/** A limb of joints one after another: names and offsets, centimetres. */
const limb = ([[name, offset], ...rest]) =>
    rest.length === 0
        ? `JOINT ${name} {\nOFFSET ${offset}\n${turns}\nEnd Site {\nOFFSET 0 0 1\n}\n}\n`
        : `JOINT ${name} {\nOFFSET ${offset}\n${turns}\n${limb(rest)}}\n`;
const side = (name, x) => [
    limb([[`${name}UpLeg`, `${10 * x} 0 0`], [`${name}Leg`, "0 -42 0"], [`${name}Foot`, "0 -42 0"]]),
    limb([[`${name}Arm`, `${18 * x} 48 0`], [`${name}ForeArm`, `${28 * x} 0 0`], [`${name}Hand`, `${25 * x} 0 0`]]),
];
/** A person who nods and sways for a second, centimetres, y up. */
const person = () => {
    const limbs = [limb([["Spine", "0 20 0"], ["Neck", "0 30 0"], ["Head", "0 12 0"]]), ...side("Left", 1), ...side("Right", -1)];
    const frames = Array.from({ length: 31 }, (_, k) => {
        const sway = 5 * Math.sin((2 * Math.PI * k) / 30);
        return [sway, 90, 0, ...Array(48).fill(0).map((_, j) => (j === 4 ? sway : 0))].join(" ");
    });
    return `HIERARCHY\nROOT Hips {\nOFFSET 0 90 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n${limbs.join("")}}\n` +
        `MOTION\nFrames: 31\nFrame Time: 0.0333333\n${frames.join("\n")}\n`;
};

test("a person's movement on a NAO", () => {
    const capture = MotionCapture.fromBytes(new TextEncoder().encode(person()), "sway.bvh");
    const robot = Robot.fromUrdf(text("aldebaran_nao.urdf"), "nao.urdf", { baseJoint: "free" });
    const found = retarget(robot, capture.clip);
    const { lower, upper, configurationLen: length } = robot.model;
    assert.equal(found.frames, 31);
    const q = found.q.slice();
    assert.equal(q.length, 31 * length);
    assert.ok(q.every((value, k) => lower[k % length] <= value && value <= upper[k % length]));
    assert.ok(found.meanError < 0.1, `${found.meanError} m`);
    assert.throws(() => retarget(robot, capture.clip, "{}"), Error);
    assert.throws(() => retarget(robot, capture.clip, undefined, { speed: 2 }), /speed.*fps/s);
});
