// During a clip a hand reaches a target, and feet are planted. The capture is in centimetres.
import assert from "node:assert/strict";
import test from "node:test";
import { MotionCapture, World } from "kinopt";
import { text } from "./panda.js";

const bytes = new TextEncoder().encode(text("captures/steps.bvh"));
const { armature, clip } = MotionCapture.fromBytes(bytes, "steps.bvh");
/** Origin of a bone at a time of a clip. */
const bonePosition = (shownClip, bone, seconds) => {
    const k = armature.names.indexOf(bone);
    return [...armature.places(shownClip.sample(seconds)).subarray(3 * k, 3 * k + 3)];
};
const away = (a, b) => Math.hypot(...a.map((value, k) => value - b[k]));
const [HAND, FEET] = ["LeftHand", ["LeftFoot", "RightFoot"]];

test("a bone reaches a target within its span only", () => {
    const target = bonePosition(clip, HAND, 1).map((value, k) => value + [5, 10, 5][k]);
    const edited = clip.withIk({ reach: [{ bone: HAND, target, span: [0.5, 1.5], fade: 0.2 }], keysPerSecond: 30 });
    assert.deepEqual(edited.report.led.map(({ bone }) => bone), [HAND]);
    assert.ok(edited.report.led[0].miss < 0.01, `${edited.report.led[0].miss}`);
    assert.ok(away(bonePosition(edited.clip, HAND, 1), target) < 0.05);
    assert.ok(away(bonePosition(edited.clip, HAND, 3), bonePosition(clip, HAND, 3)) < 1e-3);
});

test("planted feet are motionless on the world's ground", () => {
    const edited = clip.withIk({ plant: FEET, keysPerSecond: 30 });
    assert.ok(edited.report.stances.length >= 4);
    for (const { bone, span: [from, to], place: position, slide, stray } of edited.report.stances) {
        assert.ok(slide < 0.05 && stray < 0.1);
        assert.ok(away(bonePosition(edited.clip, bone, 0.5 * (from + to)), position) < 0.1);
    }
    const stage = new World();
    stage.addBox("stage", [5000, 20, 5000]);
    const raised = clip.withIk({ plant: FEET, keysPerSecond: 30, ground: stage });
    assert.ok(Math.abs(raised.report.stances[0].place[1] - edited.report.stances[0].place[1] - 10) < 0.1);
});

test("invalid requests are errors", () => {
    assert.throws(() => clip.withIk({}), /no reach and no planted bone/);
    assert.throws(() => clip.withIk({ plant: ["LeftPaw"] }), /LeftPaw/);
    assert.throws(() => clip.withIk({ reach: [{ bone: HAND, target: [1, 2] }] }), /target has 2 numbers/);
    assert.throws(() => clip.withIk({ reach: [{ bone: HAND, target: [1, 2, 3], from: 1 }] }), /from.*span/s);
    assert.throws(() => clip.withIk({ plant: FEET, rootVelocity: "hands" }), /rootVelocity is "hands"/);
    assert.throws(() => clip.withIk({ plant: FEET, ground: 3 }), /ground must be a World/);
});
