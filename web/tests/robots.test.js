// Robots from MJCF, their SRDF, and paths of arms with few reconfigurations.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import test from "node:test";
import { Arm, CartesianPath, ForwardKinematics, framePlacement, Problem, Robot, Solver, solvePath, Srdf, tasks } from "kinopt";
import { humanoid } from "./humanoid.js";
import { model, panda, pandaArm } from "./panda.js";

test("an MJCF robot has the file's kinematics", () => {
    const robot = Robot.fromMjcf(`<mujoco model="two"><compiler angle="degree"/><worldbody><body name="upper" pos="0 0 1">
        <joint name="shoulder" type="hinge" axis="0 1 0" range="-90 90"/><geom type="capsule" size="0.05 0.2"/>
        <body name="lower" pos="0.5 0 0"><joint name="elbow" type="hinge" axis="0 1 0" range="0 120"/><geom size="0.05"/>
        <site name="tip" pos="0.4 0 0"/></body></body></worldbody></mujoco>`, "two.xml");
    assert.deepEqual(robot.model.jointNames.filter((name) => /shoulder|elbow/.test(name)), ["shoulder", "elbow"]);
    assert.ok(Math.abs(robot.model.upper[1] - (2 * Math.PI) / 3) < 1e-12);
    const tip = robot.model.frameNames.find((name) => name.endsWith("tip"));
    const placed = framePlacement(robot.model, tip, [0.3, 0.4]);
    const expected = [0.5 * Math.cos(0.3) + 0.4 * Math.cos(0.7), 0, 1 - 0.5 * Math.sin(0.3) - 0.4 * Math.sin(0.7)];
    expected.forEach((value, k) => assert.ok(Math.abs(placed[12 + k] - value) < 1e-12));
    assert.throws(() => Robot.fromMjcf("<mujoco><worldbody><body><joint type='spiral'/></body></worldbody></mujoco>", "odd.xml"), /odd\.xml.*spiral/s);
    const free = Robot.fromMjcf("<mujoco><worldbody><body name='b'><geom size='1'/></body></worldbody></mujoco>", "b.xml", { baseJoint: "free" });
    assert.equal(free.model.configurationLen, 7);
});

test("an SRDF has groups, states, effectors and pairs", () => {
    const robot = panda();
    const joints = robot.chain("base", "flange");
    const srdf = Srdf.parse(`<robot name="${robot.name}"><group name="arm"><chain base_link="base" tip_link="flange"/></group>
        <group_state name="bent" group="arm"><joint name="${joints[3]}" value="-1.5"/></group_state>
        <group name="grip"><link name="hand"/></group><end_effector name="gripper" parent_link="flange" group="grip"/>
        <disable_collisions link1="hand" link2="flange" reason="Adjacent"/></robot>`, robot);
    assert.deepEqual(srdf.groups.arm, joints);
    assert.deepEqual(srdf.states, ["bent"]);
    assert.equal(srdf.state("bent")[robot.model.jointNames.indexOf(joints[3])], -1.5);
    assert.deepEqual(srdf.endEffectors, [{ name: "gripper", group: "grip", parentLink: "flange" }]);
    assert.deepEqual(srdf.disabledPairs, [["hand", "flange"]]);
    assert.deepEqual(srdf.passiveJoints, []);
    assert.throws(() => srdf.state("straight"), /straight.*bent/s);
    assert.throws(() => Srdf.parse('<robot name="x"><group name="g"><joint name="knee"/></group></robot>', robot, "odd.srdf"), /odd\.srdf.*knee/s);
    const knee = '<robot name="x"><passive_joint name="knee"/></robot>';
    const mended = Srdf.parse(knee, robot, "odd.srdf", { lenient: true });
    assert.match(mended.repairs.join(), /^1: passive_joint `knee`: left out: /);
    assert.throws(() => Srdf.parse(knee, robot, "odd.srdf", { lenien: true }), /lenien/);
    const arm = new Arm(robot, "base", "flange", { only: srdf.groups.arm, held: robot.model.neutral() });
    assert.equal(arm.degreesOfFreedom, 7);
});

test("a path has one branch, and reports unreached points", () => {
    const arm = pandaArm();
    const begin = arm.baseFromTool([0, -0.4, 0, -2, 0, 1.6, 0.8]);
    const points = (length) => Float64Array.from({ length: 16 * 61 }, (_, k) => begin[k % 16] + (k % 16 === 13 ? (length * Math.floor(k / 16)) / 60 : 0));
    const path = points(0.5);
    const solution = solvePath(arm, path);
    assert.ok(solution.reached && solution.jumps.length === 0, JSON.stringify(solution.report.missed));
    assert.ok(solution.report.largestDeviation < 1e-3);
    const q = solution.q.slice();
    for (let k = 0; k < 61; k += 1) {
        const tool = arm.baseFromTool(q.subarray(7 * k, 7 * k + 7));
        assert.ok(Math.max(...tool.map((value, j) => Math.abs(value - path[16 * k + j]))) < 2e-6);
        if (k > 0) assert.ok(q.subarray(7 * k, 7 * k + 7).every((value, j) => Math.abs(value - q[7 * (k - 1) + j]) < 0.2));
    }
    const times = solution.times({ accelerationLimits: 5, velocityLimits: 1 });
    assert.ok(times[0] === 0 && times.every((time, k) => k === 0 || time > times[k - 1]));
    const beyond = solvePath(arm, points(3), { maxStep: 0.3 });
    assert.ok(!beyond.reached && beyond.report.missed.at(-1).index === 60 && /reach|found/.test(beyond.report.missed.at(-1).reason));
    assert.equal(beyond.unreached.at(-1), 60);
    assert.throws(() => beyond.times({ accelerationLimits: 5 }), /rows are not reached/);
    assert.equal(beyond.times({ accelerationLimits: 5, allowUnreached: true }).length, 61);
    assert.throws(() => solution.times({ accelerations: 5 }), /accelerationLimits/);
    assert.throws(() => solvePath(arm, path, { traversal: "back" }), /back.*cyclic/s);
    // The second half is for a tool that is 5 cm longer.
    const longer = Float64Array.from({ length: 16 }, (_, k) => (k % 5 === 0 ? 1 : k === 14 ? 0.05 : 0));
    const toolOfPoints = Array.from({ length: 61 }, (_, k) => (k < 30 ? 0 : 1));
    const near = points(0.3);
    const two = solvePath(arm, near, { tools: longer, toolOfPoints });
    assert.deepEqual([two.report.missed, two.q.length], [[], 61 * 7]);
    // The change of tools is the only long step, if there is one.
    assert.ok(two.jumps.every(({ index }) => index === 30));
    const last = arm.baseFromTool(two.q.slice(-7));
    const offset = [0, 1, 2].map((axis) => last[12 + axis] - near[16 * 60 + 12 + axis]);
    assert.ok(Math.abs(Math.hypot(...offset) - 0.05) < 4e-6, `${offset}`);
    assert.throws(() => solvePath(arm, path, { toolOfPoints }), /tool 1/);
    assert.throws(() => solvePath(arm, path, { toolOfPoints: [0.5] }), /toolOfPoints.*whole/);
    const slow = solvePath(arm, path, { times: Array.from({ length: 61 }, (_, k) => k / 1000), keepTimes: true });
    assert.ok(slow.jumps.length > 0);
    assert.throws(() => solvePath(arm, path.subarray(0, 17)), /16/);
});

test("segments continue a path through their keys", () => {
    const arm = pandaArm();
    const home = arm.baseFromTool(arm.defaultStart);
    const moved = (x, y, z) => home.map((value, k) => value + ([x, y, z][k - 12] ?? 0));
    const over = [...moved(-0.05, 0, 0.05).subarray(12, 15)];
    const lines = new CartesianPath(home).through([...moved(0, 0.1, 0), ...moved(0, 0.1, -0.1), ...moved(0, 0.1, 0)]);
    const path = lines.arcThrough(over, moved(0, -0.1, 0)).splineThrough([...moved(0, -0.1, -0.1), ...moved(0, 0, -0.1)], 0.005);
    const solved = solvePath(arm, path, { start: arm.defaultStart });
    assert.ok(solved.reached && solved.q.length === (7 * path.points.length) / 16);
    assert.ok(solved.report.largestDeviation < 1e-3);
    const { points } = path;
    for (let k = 16; k < points.length; k += 16) {
        const step = Math.hypot(...[12, 13, 14].map((axis) => points[k + axis] - points[k - 16 + axis]));
        assert.ok(step <= 0.01 + 1e-12, `${k / 16}: ${step}`);
    }
    assert.throws(() => path.through(home, 0), /step/);
    assert.throws(() => new CartesianPath(home).arcThrough(over, home), /on one line/);
});

test("masses of robots and rigs are those of tasks", () => {
    const total = (masses) => Object.values(masses).reduce((sum, [mass]) => sum + mass, 0);
    const nao = Robot.fromUrdf(readFileSync(model("aldebaran_nao.urdf"), "utf8"), "nao.urdf", { baseJoint: "free" });
    // 5.195 kg by its documentation.
    assert.ok(Math.abs(total(nao.masses) - 5.195) < 0.01, `${total(nao.masses)} kg`);
    const rig = humanoid();
    assert.ok(total(rig.masses) > 50 && total(rig.masses) < 90, `${total(rig.masses)} kg`);
    const { model: free } = Robot.ofModel(rig.model, { baseJoint: "free" });
    const rest = free.neutral();
    const over = (x) => tasks.centerOfMass([x, 0], { masses: rig.masses, tolerance: 1e-6 });
    const solution = new Solver().solve(new Problem(free, [over(0.05), tasks.posture(rest)]), rest);
    assert.ok(solution.reached, solution.explain());
    // The whole body moved: the mean of the bones' centres of mass is at its target.
    const kinematics = new ForwardKinematics(free, Object.keys(rig.masses));
    const placed = kinematics.place(solution.q);
    const moment = Object.values(rig.masses).reduce((sum, [mass, x, y, z], k) => {
        const m = placed.subarray(16 * k, 16 * k + 16);
        return sum + mass * (m[0] * x + m[4] * y + m[8] * z + m[12]);
    }, 0);
    assert.ok(Math.abs(moment / total(rig.masses) - 0.05) < 1e-6, `${moment / total(rig.masses)} m`);
});
