// A character is dragged, posed and played.
import assert from "node:assert/strict";
import test from "node:test";
import { Drag, MotionCapture, Problem, Recording, Scene, SceneFile, Solver, tasks } from "kinopt";
import { humanoid, pinned } from "./humanoid.js";

test("a hand is dragged along 300 points without a jump", () => {
    const rig = humanoid();
    let q = rig.model.neutral();
    const pins = pinned(rig, q);
    assert.ok(rig.constrained.includes("left_hand"));
    const from = pins[rig.constrained.indexOf("left_hand")].target;
    const drag = new Drag(new Problem(rig.model, pins), q);
    const { lower, upper } = rig.model;
    for (let k = 0; k < 300; k += 1) {
        const turn = (2 * Math.PI * k) / 300;
        const down = 1 - Math.cos(turn);
        const target = [from[0] + 0.1 * Math.sin(turn), from[1] - 0.15 * down, from[2] - 0.1 * down];
        const solution = drag.advance({ left_hand: target });
        const next = solution.q;
        assert.ok(next.every((value, j) => lower[j] <= value && value <= upper[j]));
        assert.ok(next.every((value, j) => Math.abs(value - q[j]) <= 0.1500001));
        // A frame ends after 40 steps; the next one continues.
        assert.ok(solution.reached || solution.positionError < 1e-5, `${k}: ${solution.explain()}`);
        q = next;
    }
    assert.deepEqual(drag.q, q);
});

test("an unreachable hand is reported with its limits", () => {
    const rig = humanoid();
    const rest = rig.model.neutral();
    const problem = new Problem(rig.model, pinned(rig, rest));
    const solution = new Solver().solve(problem, rest, { left_hand: [5, 0, 1] });
    assert.ok(!solution.reached && solution.tasks.some(({ name, reached }) => name === "left_hand" && !reached));
    assert.ok(Array.isArray(solution.activeLimits));
    assert.throws(() => new Solver().solve(problem, rest, { left_hnd: [5, 0, 1] }), /left_hnd.*left_hand/s);
    assert.throws(() => new Solver().solve(problem, rest, { left_hand: [5, 0] }), /the target of left_hand has 2 numbers, expected 3/);
    assert.throws(() => new Solver().solve(problem, rest, { left_hand: [NaN, 0, 1] }), /the target of left_hand.*finite/s);
});

test("the skin equals the mesh at rest and moves along", () => {
    const rig = humanoid();
    const rest = rig.model.neutral();
    const all = ["lbs", "dqs"].map((method) => {
        const skin = rig.posing(method);
        skin.deform(rest);
        assert.equal(skin.normals.length, skin.positions.length);
        return skin.positions.slice();
    });
    assert.ok(all[0].every((value, k) => Math.abs(value - all[1][k]) < 1e-5));
    assert.equal(rig.triangles.length % 3, 0);
    assert.ok(rig.triangles.every((corner) => corner < all[0].length / 3));
    const span = rig.clip.timeSpan;
    const moved = rig.posing("dqs");
    moved.deform(rig.clip.sample(0.5 * (span[0] + span[1]), "loop"));
    assert.ok(moved.positions.some((value, k) => Math.abs(value - all[0][k]) > 0.01));
    assert.throws(() => rig.posing("best"), /lbs.*dqs/);
});

test("a capture is played, and dragged from its pose", () => {
    const capture = MotionCapture.fromBytes(new TextEncoder().encode(
        "HIERARCHY\nROOT hips {\nOFFSET 0 100 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n" +
        "JOINT spine {\nOFFSET 0 40 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nJOINT neck {\nOFFSET 0 30 0\n" +
        "CHANNELS 3 Zrotation Xrotation Yrotation\nEnd Site {\nOFFSET 0 20 0\n}\n}\n}\n}\n" +
        "MOTION\nFrames: 2\nFrame Time: 0.5\n0 100 0 0 0 0 0 0 0 0 0 0\n0 100 0 0 0 0 90 0 0 0 0 0\n",
    ));
    assert.deepEqual(capture.armature.names, ["hips", "spine", "neck", "neck/tip"]);
    assert.deepEqual([...capture.armature.parents], [-1, 0, 1, 2]);
    const bent = capture.clip.sample(0.5);
    const placed = capture.armature.localToModel(bent);
    const tip = placed.slice(16 * 3 + 12, 16 * 3 + 15);
    // A quarter turn about z takes up to the left.
    [-50, 140, 0].forEach((value, k) => assert.ok(Math.abs(tip[k] - value) < 1e-3, `${tip}`));
    const figure = capture.figure(capture.armature.rest);
    const { skeleton } = figure;
    const q = skeleton.model.neutral();
    const target = [20, 170, 0];
    const task = tasks.point(skeleton.tip("neck/tip"), target, { name: "head" });
    const problem = Problem.holding(skeleton, ["neck/tip"], [task], q);
    assert.throws(() => Problem.holding(skeleton, ["neck/tip"], [task], q, { only: ["neck"] }), /`only`.*bounds/);
    const drag = new Drag(problem, q);
    const solution = drag.settle();
    assert.ok(solution.reached && drag.isAtRest, solution.explain());
    const reached = capture.armature.localToModel(figure.toPose(solution.q)).slice(60, 63);
    target.forEach((value, k) => assert.ok(Math.abs(reached[k] - value) < 1e-2, `${reached}`));
});

/** A capture of a person in a T-pose with straight limbs, who faces z: name, offset and children. */
function person() {
    const leg = (side, x) => [`${side}UpLeg`, [x, -5, 0], [[`${side}Leg`, [0, -45, 0], [[`${side}Foot`, [0, -42, 0],
        [[`${side}ToeBase`, [0, -8, 15], []]]]]]]];
    const arm = (side, sign) => [`${side}Arm`, [18 * sign, 12, 0], [[`${side}ForeArm`, [28 * sign, 0, 0],
        [[`${side}Hand`, [26 * sign, 0, 0], []]]]]];
    const spine = ["Spine", [0, 10, 0], [["Chest", [0, 20, 0], [arm("Left", 1), arm("Right", -1)]]]];
    let joints = 0;
    const text = ([name, offset, children], kind = "JOINT") => {
        joints += 1;
        const below = children.length > 0 ? children.map((child) => text(child)).join("") : "End Site\n{\nOFFSET 0 0 1\n}\n";
        return `${kind} ${name}\n{\nOFFSET ${offset.join(" ")}\nCHANNELS 3 Zrotation Xrotation Yrotation\n${below}}\n`;
    };
    const tree = text(["Hips", [0, 100, 0], [leg("Left", 10), leg("Right", -10), spine]], "ROOT");
    return `HIERARCHY\n${tree}MOTION\nFrames: 1\nFrame Time: 0.1\n${"0 ".repeat(3 * joints)}\n`;
}

test("knees and elbows are guessed hinges, and bend the right way", () => {
    const capture = MotionCapture.fromBytes(new TextEncoder().encode(person()));
    const { skeleton: free } = capture.figure(capture.armature.rest);
    const hinges = free.guessHinges();
    assert.deepEqual(Object.keys(hinges).sort(), ["LeftForeArm", "LeftLeg", "RightForeArm", "RightLeg"]);
    assert.equal(hinges.LeftLeg.source, "body direction");
    const skeleton = free.withHinges(hinges);
    assert.deepEqual(Object.keys(skeleton.hinges).sort(), Object.keys(hinges).sort());
    assert.deepEqual(free.hinges, {});
    const q = skeleton.model.neutral();
    const soft = skeleton.holdPostures(["LeftFoot"], q);
    assert.ok(soft.length > 0 && soft.every((task) => task.kind === "posture"));
    const point = tasks.point(skeleton.tip("LeftFoot"), [10, 40, 20], { name: "foot" });
    const problem = Problem.holding(skeleton, ["LeftFoot"], [point, ...soft], q);
    const solution = new Drag(problem, q).settle();
    assert.ok(solution.reached, solution.explain());
    const bend = solution.q[skeleton.model.coordinateNames.indexOf("LeftLeg/bend")];
    assert.ok(bend > 0.1, `${bend}`);
    assert.throws(() => free.withHinges({ Knee: hinges.LeftLeg }), /Knee/);
});

/**
 * A strip of three vertices on two bones; the second bone rotates by a quarter turn in a second. A file and its buffer.
 */
function strip() {
    const parts = [
        new Float32Array([0, 0, 0, 0, 1, 0, 0, 2, 0]),
        new Float32Array([0, 0, 1, 0, 0, 1, 0, 0, 1]),
        new Uint8Array([0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0]),
        new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0]),
        new Uint32Array([0, 1, 2]),
        new Float32Array([0, 1]),
        new Float32Array([0, 0, 0, 1, 0, 0, Math.SQRT1_2, Math.SQRT1_2]),
    ];
    const types = [[3, "VEC3", 5126], [3, "VEC3", 5126], [3, "VEC4", 5121], [3, "VEC4", 5126], [3, "SCALAR", 5125], [2, "SCALAR", 5126], [2, "VEC4", 5126]];
    let byteOffset = 0;
    const bufferViews = parts.map(({ byteLength }) => {
        const view = { buffer: 0, byteOffset, byteLength };
        byteOffset += byteLength;
        return view;
    });
    const accessors = types.map(([count, type, componentType], bufferView) => ({ bufferView, componentType, count, type }));
    Object.assign(accessors[0], { min: [0, 0, 0], max: [0, 2, 0] });
    Object.assign(accessors[5], { min: [0], max: [1] });
    const file = {
        asset: { version: "2.0" },
        buffers: [{ uri: "strip.bin", byteLength: byteOffset }],
        bufferViews,
        accessors,
        meshes: [{ primitives: [{ attributes: { POSITION: 0, NORMAL: 1, JOINTS_0: 2, WEIGHTS_0: 3 }, indices: 4 }] }],
        nodes: [{ name: "low", children: [1] }, { name: "high", translation: [0, 1, 0], children: [3] }, { mesh: 0, skin: 0 }, { name: "end", translation: [0, 1, 0] }],
        // Bound at rest: missing inverse bind matrices are identities.
        skins: [{ joints: [0, 1] }],
        scenes: [{ nodes: [0, 2] }],
        scene: 0,
        animations: [{ name: "bend", samplers: [{ input: 5, output: 6 }], channels: [{ sampler: 0, target: { node: 1, path: "rotation" } }] }],
    };
    const buffer = new Uint8Array(byteOffset);
    parts.forEach((part, k) => buffer.set(new Uint8Array(part.buffer), bufferViews[k].byteOffset));
    return [new TextEncoder().encode(JSON.stringify(file)), buffer];
}

test("a scene is played, and dragged from its clip's pose", () => {
    const [file, buffer] = strip();
    const requestedFiles = [];
    const scene = Scene.fromBytes(file, "strip.gltf", (name) => (requestedFiles.push(name), name === "strip.bin" ? buffer : undefined));
    assert.deepEqual(requestedFiles, ["strip.bin"]);
    const [clip] = scene.clips;
    assert.deepEqual([clip.name, clip.duration], ["bend", 1]);
    for (const method of ["lbs", "dqs"]) {
        const skin = scene.posing(method);
        assert.deepEqual([...skin.triangles], [0, 1, 2]);
        skin.deform(clip.sample(1));
        // W of the second bone: a quarter turn about z at (0, 1, 0); its vertices are in its own coordinates.
        const expectedPositions = [0, 0, 0, -1, 1, 0, -2, 1, 0];
        skin.positions.forEach((value, k) => assert.ok(Math.abs(value - expectedPositions[k]) < 1e-5, `${method} ${skin.positions}`));
        assert.equal(skin.normals.length, 9);
    }
    const figure = scene.figure(clip.sample(1));
    const { skeleton } = figure;
    const q = skeleton.model.neutral();
    const task = tasks.point(skeleton.tip("end"), [0, 2, 0], { name: "end" });
    const solution = new Drag(new Problem(skeleton.model, [task]), q).settle();
    assert.ok(solution.reached, solution.explain());
    const placed = scene.armature.localToModel(figure.toPose(solution.q));
    const at = scene.armature.names.indexOf("end");
    [0, 2, 0].forEach((value, k) => assert.ok(Math.abs(placed[16 * at + 12 + k] - value) < 1e-3, `${placed.slice(16 * at + 12, 16 * at + 15)}`));
    assert.throws(() => Scene.fromBytes(file, "strip.gltf"), /strip\.gltf.*strip\.bin/s);
});

test("an armature without scale has the joints of its translations", () => {
    const nodes = [
        { name: "low", scale: [2, 1, 1], children: [1] },
        { name: "high", translation: [1, 0, 0], children: [2] },
        { name: "end", translation: [1, 0, 0] },
    ];
    const file = { asset: { version: "2.0" }, nodes, scenes: [{ nodes: [0] }], scene: 0 };
    const { armature: scaled } = Scene.fromBytes(new TextEncoder().encode(JSON.stringify(file)), "scaled.gltf");
    const plain = scaled.withoutScale();
    assert.deepEqual([scaled.scaleNotes.length, plain.scaleNotes.length], [1, 0]);
    const at = scaled.names.indexOf("end");
    const positions = [scaled, plain].map((armature) => [...armature.localToModel(armature.rest).slice(16 * at + 12, 16 * at + 15)]);
    assert.deepEqual(positions, [[4, 0, 0], [2, 0, 0]]);
});

test("solved poses become a clip of a scene or a capture", () => {
    const [gltf, buffer] = strip();
    const open = () => buffer;
    const file = SceneFile.fromBytes(gltf, "strip.gltf", open);
    const scene = Scene.fromBytes(gltf, "strip.gltf", open);
    const [original] = scene.clips;
    const recording = new Recording(file.armature, 10);
    for (let k = 0; k <= 5; k += 1) recording.add(original.sample(0.2 * k));
    const clip = recording.clip("again");
    assert.equal(recording.frames, 6);
    assert.ok(Math.abs(clip.duration - 0.5) < 1e-6);
    file.addClip(clip);
    assert.throws(() => file.addClip(clip), /again/);
    const read = Scene.fromBytes(file.toBytes(), "more.gltf", open);
    assert.deepEqual(read.clips.map(({ name }) => name), file.clipNames);
    const placed = (of, name, seconds) => of.armature.localToModel(of.clips.find((one) => one.name === name).sample(seconds));
    // Twice as fast as before.
    const before = placed(scene, original.name, 0.6);
    placed(read, "again", 0.3).forEach((value, k) => assert.ok(Math.abs(value - before[k]) < 1e-5));
    const capture = MotionCapture.fromBytes(new TextEncoder().encode(recording.toBvh()), "again.bvh");
    assert.equal(capture.frames, 6);
    assert.throws(() => new Recording(file.armature, 0), /fps/);
    const figure = MotionCapture.fromBytes(new TextEncoder().encode(
        "HIERARCHY\nROOT a {\nOFFSET 0 0 0\nCHANNELS 0\nEnd Site {\nOFFSET 0 1 0\n}\n}\nMOTION\nFrames: 1\nFrame Time: 0.1\n\n"));
    assert.throws(() => recording.add(figure.armature.rest), /the pose has 2 bones, expected 4/);
});
