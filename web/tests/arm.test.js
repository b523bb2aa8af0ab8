// An arm reaches every reachable pose, and reports misses.
import assert from "node:assert/strict";
import test from "node:test";
import { Arm, CollisionModel, placement, Robot, World } from "kinopt";
import { configuration, panda, pandaArm, random, text } from "./panda.js";

const largestDifference = (a, b) => Math.max(...a.map((value, k) => Math.abs(value - b[k])));

test("500 reachable poses are reached by every search", () => {
    for (const search of ["start", "first", "nearest"]) {
        const arm = pandaArm({ search });
        const draw = random(7);
        for (let k = 0; k < (search === "nearest" ? 100 : 500); k += 1) {
            const target = arm.baseFromTool(configuration(arm, draw));
            const solution = arm.solve(target, configuration(arm, draw));
            assert.ok(solution.reached, `${search} ${k}: ${solution.explain()}`);
            assert.ok(largestDifference(arm.baseFromTool(solution.q), target) < 2e-6);
            const { lower, upper } = arm;
            assert.ok(solution.q.every((value, j) => lower[j] <= value && value <= upper[j]));
        }
    }
});

test("a batch equals single solves", () => {
    const arm = pandaArm();
    const draw = random(3);
    const starts = Array.from({ length: 40 }, () => configuration(arm, draw));
    const targets = starts.map((q) => arm.baseFromTool(q.map((value) => 0.9 * value)));
    const join = (lists) => Float64Array.from(lists.flatMap((list) => [...list]));
    const batch = arm.solveBatch(join(targets), join(starts));
    const q = batch.q.slice();
    assert.deepEqual([...batch.reached], Array(40).fill(1));
    targets.forEach((target, k) => assert.deepEqual(arm.solve(target, starts[k]).q, q.slice(7 * k, 7 * k + 7)));
    assert.ok(batch.positionError.every((error) => error <= 1e-6));
});

test("an unreachable target is reported, not thrown", () => {
    const arm = pandaArm();
    const solution = arm.solve(placement([3, 0, 0.5]));
    assert.equal(solution.reached, false);
    assert.ok(solution.isOutOfReach);
    assert.match(solution.explain(), /reach/);
    assert.ok(solution.positionError > 1.5);
});

test("a path stays on its branch, also by single targets", () => {
    const arm = pandaArm();
    const start = [0, -0.4, 0, -2, 0, 1.6, 0.8];
    const path = Array.from({ length: 50 }, (_, k) => {
        const target = arm.baseFromTool(start);
        target[13] += 0.004 * k;
        return target;
    });
    const track = arm.track(path.flatMap((target) => [...target]), start);
    assert.ok(track.reached && track.jumps.length === 0);
    assert.ok(track.report.reached.every((one) => one === 1));
    const q = track.q.slice();
    const follower = arm.follower(start);
    path.forEach((target, k) => {
        const { reached, q: nextQ } = follower.advance(target);
        assert.ok(reached && !follower.jumped);
        assert.ok(largestDifference([...nextQ], [...q.slice(7 * k, 7 * k + 7)]) < 0.05);
    });
    const servo = arm.servo(start, 1e-3);
    for (let tick = 0; tick < 300; tick += 1) servo.step(path[10]);
    assert.ok(servo.reached, `${servo.positionError} m`);
});

test("a servo keeps the given velocity limits", () => {
    const arm = pandaArm();
    const start = [0, -0.4, 0, -2, 0, 1.6, 0.8];
    const target = arm.baseFromTool(start);
    target[13] += 0.2;
    const servo = arm.servo(start, 0.01, { velocityLimits: Array(7).fill(0.3), damping: 0.02 });
    assert.deepEqual([...servo.velocityLimits], Array(7).fill(0.3));
    let before = servo.q;
    for (let tick = 0; tick < 50; tick += 1) {
        const q = servo.step(target);
        assert.ok(largestDifference([...q], [...before]) <= 0.003 * (1 + 1e-12));
        before = q;
    }
    assert.throws(() => arm.servo(start, 0.01, { velocityLimits: [1] }), /velocityLimits has 1 numbers/);
    assert.throws(() => arm.servo(start, 0.01, { speed: 1 }), /speed.*velocityLimits/s);
});

test("a time limit ends a search and is reported", () => {
    const unreachable = placement([3, 0, 0.5]);
    const { termination, reached, q } = pandaArm({ timeLimit: 0, search: "first" }).solve(unreachable);
    assert.deepEqual([termination, reached, q.length], ["time_limit", false, 7]);
    // A long time limit ends nothing.
    const start = [0, -0.4, 0, -2, 0, 1.6, 0.8];
    const target = pandaArm().baseFromTool(start.map((value) => value + 0.1));
    assert.deepEqual(pandaArm({ timeLimit: 60 }).solve(target, start).q, pandaArm().solve(target, start).q);
    assert.throws(() => pandaArm({ timeLimit: -1 }), /timeLimit is -1 s/);
    assert.throws(() => pandaArm({ timeLimit: NaN }), /timeLimit is NaN s/);
});

test("several solutions differ", () => {
    const arm = pandaArm();
    const target = arm.baseFromTool([0.3, -0.4, 0.2, -2, 0.1, 1.6, 0.8]);
    const { solutions, complete } = arm.solveAll(target);
    assert.ok(solutions.length >= 2 && !complete);
    for (const one of solutions) {
        assert.ok(one.positionError <= 1e-6);
        for (const other of solutions) assert.ok(one === other || largestDifference([...one.q], [...other.q]) > 0.1);
    }
});

test("reachability is a solution or a proof", () => {
    const arm = pandaArm();
    const q = [0.3, -0.4, 0.2, -2, 0.1, 1.6, 0.8];
    const near = arm.reachability(arm.baseFromTool(q));
    assert.ok(near.reachable && near.solution.reached && near.boxes === 0);
    // The flange 0.8 m in front points back to the base.
    const backwards = placement([0.8, 0, 0.3], { rpy: [0, -1.57, 0] });
    const far = arm.reachability(backwards);
    assert.ok(far.reachable === false && far.boxes > 1 && /boxes/.test(far.solution.explain()));
    assert.equal(arm.reachability(backwards, undefined, 1).reachable, undefined);
});

test("goal sets rank tools and targets", () => {
    const arm = pandaArm();
    const draw = random(5);
    const goals = Array.from({ length: 5 }, () => [...arm.baseFromTool(configuration(arm, draw))]);
    goals.push([...placement([5, 0, 0])]);
    const tools = [placement([0, 0, 0]), placement([0, 0, 0.1])].map((tool) => [...tool]);
    const found = arm.solveGoals(goals.flat(), tools.flat(), "manipulability");
    assert.deepEqual(found.status.map((row) => row.length), [6, 6]);
    assert.deepEqual([found.status[0].slice(0, 5), found.status[1][5]], [Array(5).fill("reached"), "out of reach"]);
    const costs = found.ranking.map(([tool, target]) => found.cost[tool][target]);
    assert.ok(costs.length >= 5 && costs.every((cost, k) => k === 0 || costs[k - 1] <= cost));
    const [tool, target] = found.ranking[0];
    const q = found.q[tool].slice(7 * target, 7 * target + 7);
    assert.ok(largestDifference([...arm.withTool(tools[tool]).baseFromTool(q)], goals[target]) < 2e-6);
    assert.throws(() => arm.solveGoals(goals.flat(), undefined, "speed"), /speed.*manipulability/);
});

test("self-motions keep the tool at the target", () => {
    const arm = pandaArm();
    const target = arm.baseFromTool([0.3, -0.4, 0.2, -2, 0.1, 1.6, 0.8]);
    const motions = arm.selfMotions(target);
    assert.ok(motions.length > 0);
    for (const { q } of motions) {
        for (let k = 0; k < q.length; k += 70) {
            assert.ok(largestDifference([...arm.baseFromTool(q.slice(k, k + 7))], [...target]) < 2e-6);
        }
    }
});

test("an arm avoids a box and reports collisions", () => {
    const robot = panda();
    const shapes = CollisionModel.ofRobot(robot);
    const free = pandaArm();
    const target = free.baseFromTool([0, 0.4, 0, -1.8, 0, 2.2, 0.8]);
    const world = new World();
    world.addBox("shelf", [0.1, 0.6, 0.1], [target[12] - 0.15, 0, target[14] + 0.05]);
    assert.deepEqual(world.names, ["shelf"]);
    const arm = Arm.keepingClear(robot, "base", "flange", shapes, world, 0.01);
    const solution = arm.solve(target);
    assert.ok(solution.goalsReached || !solution.reached);
    assert.deepEqual(arm.collisions(solution.q), solution.reached ? [] : arm.collisions(solution.q));
    // Spheres of a file, enlarged by their gaps, change no result.
    const spheres = "collision_spheres:\n" + shapes.links.map((link) => `  ${link}:\n    - {center: [0, 0, 0], radius: 0.01}\n`).join("");
    const covered = Arm.keepingClear(robot, "base", "flange", shapes.withSpheres(spheres, "small.yml"), world, 0.01);
    assert.equal(covered.solve(target).reached, solution.reached);
    assert.throws(() => shapes.withSpheres("collision_spheres:\n  palm:\n    - {center: [0, 0, 0], radius: 1}\n", "bad.yml"), /palm/);
    world.move("shelf", [target[12], target[13], target[14]]);
    const blocked = arm.withWorld(world, 0.01).collisions([0, 0.4, 0, -1.8, 0, 2.2, 0.8]);
    assert.ok(blocked.some(({ second, distance }) => second.includes("shelf") && distance < 0.01), JSON.stringify(blocked));
    // The kind of each member of a pair is given next to its name.
    for (const { firstKind, secondKind, second, onTheWay } of blocked) {
        assert.equal(firstKind, "link");
        assert.equal(secondKind, second.includes("shelf") ? "obstacle" : "link");
        assert.equal(onTheWay, false);
    }
    for (const { first } of blocked) world.allowCollision("shelf", first);
    assert.ok(world.isCollisionAllowed(blocked[0].first, "shelf"));
    assert.deepEqual(arm.withWorld(World.fromJson(world.toJson()), 0.01).collisions([0, 0.4, 0, -1.8, 0, 2.2, 0.8]), []);
    world.forbidCollision("shelf", blocked[0].first);
    assert.equal(arm.withWorld(world, 0.01).collisions([0, 0.4, 0, -1.8, 0, 2.2, 0.8]).length, 1);
    assert.throws(() => world.allowCollision("hand", "shell"), /neither.*shelf/s);
    assert.throws(() => free.collisions(solution.q), /unknown/);
});

test("a world reports its notes", () => {
    const sheet = { name: "sheet", vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0]], triangles: [[0, 1, 2]] };
    const { notes } = World.fromJson(JSON.stringify({ meshes: [sheet] }));
    assert.equal(notes.length, 1);
    assert.match(notes[0], /sheet.*open/);
    assert.deepEqual(new World().notes, []);
});

test("errors of unknown names and options list valid ones", () => {
    assert.throws(() => new Arm(panda(), "base", "flang"), /flang.*flange/s);
    assert.throws(() => pandaArm({ serach: "first" }), /serach.*search/s);
    assert.throws(() => pandaArm({ search: "best" }), /best.*nearest/s);
    assert.throws(() => pandaArm({ attempts: -1 }), /attempts must be a whole number/);
    assert.throws(() => pandaArm({ maxMove: "much" }), /maxMove must be a list of numbers/);
    assert.throws(() => pandaArm().solve([1, 2, 3]), /target has 3 numbers, a placement has 16/);
    assert.throws(() => pandaArm().solve(placement([NaN, 0, 0])), /finite|rigid/);
    assert.throws(() => pandaArm().solve(placement(), [0, 0]), /start/);
    assert.throws(() => pandaArm().solve(placement(), ["0", 0, 0, 0, 0, 0, 0]), /start\[0\] must be a number/);
});

test("a robot has shapes, tips, limits and a base joint", () => {
    const robot = panda();
    assert.ok(robot.tips.includes("tool"));
    assert.equal(robot.chain("base", "flange").length, 7);
    const kinds = robot.model.frameNames.flatMap((frame) => robot.shapes(frame, true).map(({ kind }) => kind));
    assert.ok(kinds.includes("sphere") && kinds.includes("cylinder") && kinds.includes("box"));
    const sliding = Robot.fromUrdf(text("universal_ur5e.urdf"), "ur5e.urdf", { baseJoint: "slide-x", baseBounds: { x: [0, 1] } });
    assert.equal(sliding.model.configurationLen, 7);
    const arm = new Arm(sliding.withTool("pen", "flange", placement([0, 0, 0.1])), undefined, "pen");
    const target = arm.baseFromTool([0.7, 0.3, -1.1, 1, -0.9, 1.1, 0.4]);
    assert.ok(arm.solve(target).reached);
});

test("an arm's joints convert to a robot's configuration", () => {
    const robot = Robot.fromUrdf(text("rethink_baxter.urdf"), "rethink_baxter.urdf");
    const arm = new Arm(robot, "torso", "left_tool");
    const q = configuration(arm, random(5));
    const before = robot.model.randomConfiguration(1);
    const whole = arm.configuration(q, before);
    assert.deepEqual([...arm.jointValues(whole)], [...q]);
    assert.deepEqual([...arm.configuration(arm.jointValues(before), before)], [...before]);
});

test("starts and numbers of joints are lists, numbers or names", () => {
    const arm = pandaArm();
    const start = arm.defaultStart.slice();
    start[1] = 0.3;
    const target = arm.baseFromTool(start.map((value) => value + 0.1));
    assert.deepEqual(arm.solve(target, { joint2: 0.3 }).q, arm.solve(target, start).q);
    assert.throws(() => arm.solve(target, { joint_2: 0.3 }), /joint2/);
    const weighted = pandaArm({ maxMove: 0.01, jointWeights: { joint1: 2 } });
    assert.ok(largestDifference(weighted.solve(target, start).q, start) <= 0.01 + 1e-12);
    const narrow = pandaArm({ jointLimits: { joint3: [0.2, 0.5] } });
    assert.deepEqual([narrow.lower[2], narrow.upper[2]], [0.2, 0.5]);
    assert.throws(() => pandaArm({ jointLimits: { joint3: [-4, 0.5] } }), /joint3.*-2\.8973/);
    const q = narrow.randomConfiguration(3);
    assert.deepEqual(q, narrow.randomConfiguration(3));
    assert.ok(q.every((value, k) => narrow.lower[k] <= value && value <= narrow.upper[k]));
});
