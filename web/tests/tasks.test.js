// Every kind of task is reached, according to numbers that are independent of the solver.
import assert from "node:assert/strict";
import test from "node:test";
import { Drag, frameJacobian, framePlacement, Jacobian, placement, Problem, Robot, Solver, tasks } from "kinopt";
import { humanoid } from "./humanoid.js";
import { panda, text } from "./panda.js";

const { model } = panda();
const start = Array.from([0, -0.4, 0, -2, 0, 1.6, 0.8, ...model.neutral().slice(7)]);
const at = (frame, q) => framePlacement(model, frame, q).slice(12, 15);
const axis = (frame, k, q) => framePlacement(model, frame, q).slice(4 * k, 4 * k + 3);
const apart = (a, b) => Math.hypot(...a.map((value, k) => value - b[k]));
const dot = (a, b) => a.reduce((sum, value, k) => sum + value * b[k], 0);

/** Solution of tasks that are reached. */
function solved(list, targets, on = model, from = start) {
    const solution = new Solver().solve(new Problem(on, list), from, targets);
    assert.ok(solution.reached, solution.explain());
    return solution.q;
}

test("tasks: positions, lines of sight, distances", () => {
    const target = at("flange", start).map((value, k) => value + 0.02 * (k + 1));
    const q = solved([tasks.point("flange", target), tasks.gaze("flange", [0, 0, 1], 0.1, [0.6, 0, -2])]);
    assert.ok(apart(at("flange", q), target) < 1e-5);
    const sight = [0.6, 0, -2].map((value, k) => value - at("flange", q)[k]);
    assert.ok(dot(axis("flange", 2, q), sight) / Math.hypot(...sight) > Math.cos(0.1001));
    const along = solved([tasks.gazeAlong("flange", [0, 0, 1], 0.05, [1, 0, 0])]);
    assert.ok(axis("flange", 2, along)[0] > Math.cos(0.0501));
    const joint = model.frameNames[3];
    const farther = solved([tasks.distance(joint, "flange", 0.5, { name: "d" })], { d: 0.45 });
    assert.ok(Math.abs(apart(at(joint, farther), at("flange", farther)) - 0.45) < 1e-5);
});

test("tasks: relative poses and pixels of a camera", () => {
    const between = model.frameNames[2];
    const bent = start.map((value, k) => value + 0.1 * Math.sin(k));
    const [flangePosition, from] = [at("flange", bent), framePlacement(model, between, bent)];
    const relativePosition = [0, 1, 2].map((k) => dot(from.slice(4 * k, 4 * k + 3), flangePosition.map((value, j) => value - from[12 + j])));
    const target = placement(relativePosition);
    const q = solved([tasks.relativePose("flange", between, target, { goal: "position" })]);
    const base = framePlacement(model, between, q);
    const offset = at("flange", q).map((value, k) => value - base[12 + k]);
    const seen = [0, 1, 2].map((k) => dot(base.slice(4 * k, 4 * k + 3), offset));
    assert.ok(apart(seen, relativePosition) < 1e-5, `${seen}`);
    // A camera at (2, 0, 0.5) that looks along -x: u along the world's y, v downward.
    const camera = [-320, 500, 0, 640, -240, 0, -500, 480 + 250, -1, 0, 0, 2];
    const pixel = solved([tasks.pixel("flange", camera, [400, 200])]);
    const [x, y, z] = at("flange", pixel);
    const depth = 2 - x;
    assert.ok(Math.abs(320 + (500 * y) / depth - 400) < 1e-3 && Math.abs(240 - (500 * (z - 0.5)) / depth - 200) < 1e-3);
});

test("tasks: postures, weights, couplings, intervals", () => {
    const joints = model.jointNames;
    const free = solved([tasks.point("flange", at("flange", start)), tasks.posture({ [joints[0]]: 0.3 }, { weight: 1 })]);
    assert.ok(Math.abs(free[0] - 0.3) < 0.25);
    const coupled = solved([tasks.jointCoupling({ [joints[1]]: 1, [joints[3]]: -0.5 }, 0.9)]);
    assert.ok(Math.abs(coupled[1] - 0.5 * coupled[3] - 0.9) < 1e-5);
    const floor = at("flange", start)[2] + 0.1;
    const above = solved([tasks.bounded(tasks.plane("flange", [0, 0, 0], [0, 0, 1]), { lower: floor })]);
    assert.ok(at("flange", above)[2] > floor - 1e-5);
    const slow = tasks.smoothness(start, 0.01, { weight: 1, role: "goal", tolerance: 1e-3 });
    assert.ok(apart(solved([slow], {}, model, start.map((value) => 0.95 * value)), start) < 1e-4);
    assert.throws(() => new Problem(model, [tasks.posture({ elbow: 1 })]), /elbow.*joint/s);
    assert.throws(() => new Problem(model, [tasks.posture(start, { jointWeights: "upright-ish" })]), /by range.*upright/s);
    assert.throws(() => new Problem(model, [{ kind: "hover" }]), /kind of task.*hover.*point/s);
    assert.throws(() => new Problem(model, [tasks.bounded(tasks.bounded(tasks.limitCentring()))]), /nested `bounded`/);
    assert.throws(() => new Problem(model, [tasks.gaze("flange", [0, 0, 1], 0.1)]), /needs either `target` or `direction`/);
});

test("tasks: centre of mass and support polygon", () => {
    const rig = humanoid();
    const rest = rig.model.neutral();
    const feet = ["left_foot", "right_foot"].map((bone) => tasks.point(rig.skeleton.tip(bone), framePlacement(rig.model, rig.skeleton.tip(bone), rest).slice(12, 15)));
    const hand = tasks.point(rig.skeleton.tip("left_hand"), [0.35, 0.4, 1.1], { name: "hand" });
    solved([hand, ...feet, tasks.centerOfMass([0, 0], { tolerance: 0.05 })], {}, rig.model, rest);
    // Two masses: their centre is between them, at a quarter of the distance.
    const masses = { link4: 3, hand: [1, 0, 0, 0.2] };
    const q = solved([tasks.centerOfMass([0.2, 0.1, 0.4], { masses, name: "centre" })], { centre: [0.2, 0.15, 0.5] });
    const [elbow, grip] = [at("link4", q), framePlacement(model, "hand", q)];
    const heavy = elbow.map((value, k) => 0.75 * value + 0.25 * (grip[12 + k] + 0.2 * grip[8 + k]));
    assert.ok(apart(heavy, [0.2, 0.15, 0.5]) < 1e-5, `${heavy}`);
    const corners = [[0.1, -0.1, 0], [0.2, -0.1, 0], [0.2, 0.1, 0], [0.1, 0.1, 0]];
    const standing = solved([tasks.supportPolygon(corners, { masses: { flange: 1 } })]);
    const [x, y] = at("flange", standing);
    assert.ok(x > 0.1 - 1e-5 && x < 0.2 + 1e-5 && Math.abs(y) < 0.1 + 1e-5);
    assert.throws(() => new Problem(model, [tasks.centerOfMass([0, 0, 0])]), Error);
});

test("a robot balances over the soles of its feet", () => {
    const nao = Robot.fromUrdf(text("aldebaran_nao.urdf"), "aldebaran_nao.urdf", { baseJoint: "free" });
    const soles = Object.fromEntries(["left_sole", "right_sole"].map((foot) => [foot, nao.sole(foot)]));
    assert.deepEqual(Array.from(soles.left_sole[0]), [0, 0, 0]);
    for (const side of [0, 1]) {
        const across = soles.left_sole.map((point) => point[side]);
        assert.ok(apart([Math.min(...across), Math.max(...across)], side ? [-0.04, 0.04] : [-0.06, 0.1]) < 1e-9);
    }
    const balance = new Problem(nao.model, [tasks.supportPolygon([], { on: soles })]);
    assert.ok(new Solver().solve(balance, nao.model.neutral()).reached);
    assert.throws(() => nao.sole("left_soul"), /left_soul.*left_sole/s);
    const rest = nao.model.neutral();
    const stance = nao.crouchedConfiguration(["left_sole", "right_sole"], rest);
    const solePlacement = (q) => framePlacement(nao.model, "left_sole", q);
    assert.ok(apart(Array.from(solePlacement(stance)), solePlacement(rest)) < 1e-6);
    assert.ok(stance[2] < rest[2] - 0.01 && stance[nao.model.configurationLen - 1] !== undefined);
    assert.throws(() => nao.crouchedConfiguration(["left_soul"], rest), /left_soul/);
    assert.throws(() => nao.crouchedConfiguration(["left_sole"], rest.slice(1)), Error);
});

test("velocities and Jacobians agree with differences", () => {
    const jacobian = frameJacobian(model, "flange", start);
    const all = new Jacobian(model, ["flange", "hand"]);
    assert.equal(jacobian.length, 6 * all.columns);
    const h = 1e-6;
    for (let j = 0; j < 7; j += 1) {
        const [less, more] = [-h, h].map((step) => at("flange", start.map((value, k) => value + (k === j ? step : 0))));
        more.forEach((value, k) => assert.ok(Math.abs((value - less[k]) / (2 * h) - jacobian[6 * j + k]) < 1e-8));
    }
    const both = all.at(start);
    for (let j = 0; j < all.columns; j += 1) for (let k = 0; k < 6; k += 1) assert.equal(both[12 * j + k], jacobian[6 * j + k]);
    const previous = framePlacement(model, "flange", start);
    const moved = solved([tasks.frameVelocity("flange", previous, 0.1, { linear: [0.2, 0, 0.1] })]);
    assert.ok(apart(at("flange", moved), [0, 1, 2].map((k) => previous[12 + k] + [0.02, 0, 0.01][k])) < 1e-5);
    const volume = (q) => {
        const jacobianEntries = frameJacobian(model, "flange", q);
        const rows = [0, 1, 2].map((k) => Array.from({ length: 7 }, (_, j) => jacobianEntries[6 * j + k]));
        const [a, b, c] = rows.map((row) => rows.map((other) => dot(row, other)));
        return Math.sqrt(a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]));
    };
    const required = 1.05 * volume(start);
    const able = solved([tasks.manipulability("flange", required, { of: "position", role: "goal", tolerance: 1e-4 })]);
    assert.ok(volume(able) > 0.999 * required);
});

test("a drag follows a posture that moves", () => {
    const drag = new Drag(new Problem(model, [tasks.posture(start, { name: "clip", role: "goal", tolerance: 1e-3 })]), start);
    const next = start.map((value) => value + 0.01);
    const solution = drag.follow({ clip: next });
    assert.ok(apart(solution.q, next) < 1e-2);
    assert.throws(() => drag.advance({ clip: [0, 1] }), /the target of clip has 2 numbers/);
});

test("a rig with a base joint is a robot", () => {
    const rig = humanoid();
    const moving = Robot.ofModel(rig.model, { baseJoint: "free" });
    assert.equal(moving.model.configurationLen, rig.model.configurationLen + 7);
    assert.throws(() => Robot.ofModel(rig.model, { baseJoint: "flying" }), /flying.*free/s);
});

test("joints of a problem are locked, selected, narrowed", () => {
    const target = at("flange", start).map((value, k) => value + 0.02 * (k + 1));
    const point = tasks.point("flange", target);
    const [first, second, third] = model.jointNames;
    const solve = (options) => {
        const solution = new Solver().solve(new Problem(model, [point], options), start);
        assert.ok(solution.reached, solution.explain());
        return solution.q;
    };
    const locked = solve({ locked: { [first]: 0.1, [third]: -0.2 } });
    assert.deepEqual([locked[0], locked[2]], [0.1, -0.2]);
    const only = new Problem(model, [point], { only: [first, second], held: start });
    assert.equal(only.variables, 2);
    assert.deepEqual([...new Solver().solve(only, start).q.slice(2)], start.slice(2));
    const bounded = solve({ bounds: { [second]: [-0.45, -0.35] } });
    assert.ok(-0.45 <= bounded[1] && bounded[1] <= -0.35);
    assert.throws(() => solve({ locked: { elbow: 1 } }), /elbow/);
    assert.throws(() => solve({ held: start }), /held.*only/);
    assert.throws(() => solve({ bounds: { [second]: [1] } }), /bounds.* has 1 numbers, expected 2/);
});

test("solver options end a search", () => {
    const unreachable = new Problem(model, [tasks.point("flange", [5, 0, 0])]);
    assert.equal(new Solver({ timeLimit: 0 }).solve(unreachable, start).termination, "time_limit");
    const all = new Solver({ attempts: 20 }).solve(unreachable, start);
    const few = new Solver({ attempts: 20, agreeing: 2 }).solve(unreachable, start);
    assert.ok(few.attempts < all.attempts, `${few.attempts} of ${all.attempts}`);
    assert.ok(new Solver({ attempts: 20, restartSteps: 1 }).solve(unreachable, start).attempts < all.attempts);
    assert.throws(() => new Solver({ patience: -1 }), /patience must be a whole number/);
});
