// Exceptions have the classes of the Python package; arms, robots and solutions print names, joints and limits.
import assert from "node:assert/strict";
import test from "node:test";
import { inspect } from "node:util";
import {
    Arm, CollisionModel, FileError, InvalidFileError, InvalidValueError, KinoptError, placement, Problem, Rig, Robot, tasks, UnknownNameError, World,
} from "kinopt";
import { panda, pandaArm, text } from "./panda.js";

const robot = panda();
const arm = pandaArm();
const bytes = (string) => new TextEncoder().encode(string);
const rig = text("humanoid/humanoid.json");
const MESH = '<robot name="r"><link name="a"><collision><geometry><mesh filename="missing.stl"/></geometry></collision></link></robot>';

const FAULTS = {
    "an unknown frame": [() => new Arm(robot, "base", "elbow"), UnknownNameError, /elbow/],
    "an unknown option": [() => new Arm(robot, "base", "flange", { patience: 1 }), UnknownNameError, /patience/],
    "an unknown kind of task": [() => new Problem(robot.model, [{ kind: "hover" }]), UnknownNameError, /hover/],
    "a matrix that is no rotation": [() => arm.solve(new Float64Array(16)), InvalidValueError, /target/],
    "an option out of range": [() => pandaArm({ positionTolerance: -1 }), InvalidValueError, /positionTolerance/],
    "a start of another length": [() => arm.solve(arm.baseFromTool(arm.lower), [0]), InvalidValueError, /1/],
    "a quaternion of length 0": [() => placement([0, 0, 0], { wxyz: [0, 0, 0, 0] }), InvalidValueError, /quaternion/],
    "a damaged URDF": [() => Robot.fromUrdf("<robot>", "broken.urdf"), InvalidFileError, /broken\.urdf/],
    "a damaged world": [() => World.fromJson("{"), InvalidFileError, /./],
    "a file that is not given": [() => Rig.parse(bytes(rig), "humanoid.json", () => undefined), InvalidFileError, /humanoid\.ply/],
    "a mesh that cannot be read": [() => CollisionModel.ofRobot(Robot.fromUrdf(MESH)), FileError, /missing\.stl/],
};
for (const [what, [fail, type, message]] of Object.entries(FAULTS)) {
    test(`${what} is a ${type.name}`, () => {
        assert.throws(fail, (error) => {
            assert.equal(error.constructor, type);
            assert.ok(error instanceof KinoptError && error instanceof Error && error.stack);
            assert.equal(error.name, type.name);
            assert.match(error.message, message);
            return true;
        });
    });
}

test("an exception of a caller's function stays as it is", () => {
    const own = new RangeError("own");
    assert.throws(() => Rig.parse(bytes(rig), "humanoid.json", () => { throw own; }), own);
});

test("an unknown name is an invalid value too", () => {
    assert.ok(new UnknownNameError("") instanceof InvalidValueError);
});

test("an arm prints its name, joints and limits", () => {
    const lines = inspect(arm).split("\n");
    assert.equal(lines[0], "Arm of franka_panda from base to flange, 7 joints");
    assert.deepEqual(lines.slice(1).map((line) => line.trim().split(/\s+/)[0]), arm.jointNames);
    assert.match(lines[4], /\[-3\.072, -0\.070\] rad/);
    assert.match(inspect({ arm }), /Arm of franka_panda/);
    const { joints, base, tip } = JSON.parse(JSON.stringify(arm));
    assert.deepEqual([base, tip], ["base", "flange"]);
    assert.deepEqual(joints.map(({ lower }) => lower), Array.from(arm.lower));
    const world = JSON.parse(JSON.stringify(new Arm(robot, undefined, "flange")));
    assert.equal(world.base, null);
});

test("an arm of another arm prints alike", () => {
    assert.equal(inspect(arm.withTool(placement([0, 0, 0.1]))), inspect(arm));
});

test("a robot prints its coordinates with units", () => {
    const free = Robot.fromUrdf(text("franka_panda.urdf"), "panda.urdf", { baseJoint: "free" });
    const { name, joints } = JSON.parse(JSON.stringify(free));
    assert.equal(name, "franka_panda");
    assert.deepEqual(joints.slice(0, 8).map(({ unit }) => unit), ["m", "m", "m", "", "", "", "", "rad"]);
    assert.equal(joints[0].lower, null);
    assert.equal(joints.length, free.model.configurationLen);
    assert.match(inspect(free), /^Robot franka_panda, \d+ coordinates\n.*without limits m\n/);
    assert.match(inspect(free), /joint4 +\[-3\.072, -0\.070\] rad/);
});

test("a solution prints its result", () => {
    const far = placement([0, 0, 3]);
    const missed = arm.solve(far);
    assert.match(inspect(missed), /^Solution: Not reached/);
    assert.ok(inspect(missed).endsWith(`[${Array.from(missed.q, (value) => value.toFixed(4)).join(", ")}]`));
    assert.deepEqual(JSON.parse(JSON.stringify(missed)).q, Array.from(missed.q));
});

test("a freed object prints that it is freed", () => {
    const freed = pandaArm();
    freed.free();
    assert.equal(inspect(freed), "Arm (freed)");
});

test("tasks and printing leave the classes as they are", () => {
    assert.deepEqual(Object.keys(arm).filter((key) => !key.startsWith("__")), []);
    assert.equal(typeof tasks.point, "function");
});
