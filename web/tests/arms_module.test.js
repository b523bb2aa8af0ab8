// `kinopt/arms` has arms only, in less than half of the download, with the results of `kinopt`.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import test from "node:test";
import { inspect } from "node:util";
import { gzipSync } from "node:zlib";
import * as arms from "kinopt/arms";
import * as kinopt from "kinopt";
import { configuration, random, text } from "./panda.js";

const urdf = text("franka_panda.urdf");
const armOf = ({ Arm, Robot }) => new Arm(Robot.fromUrdf(urdf, "panda.urdf"), "base", "flange");

test("results equal those of the whole module", () => {
    const [small, whole] = [armOf(arms), armOf(kinopt)];
    const draw = random(1);
    const start = whole.defaultStart;
    for (let k = 0; k < 50; k += 1) {
        const target = whole.baseFromTool(configuration(whole, draw));
        assert.deepEqual(small.solve(target, start).q, whole.solve(target, start).q);
    }
    const target = whole.baseFromTool(start);
    const points = [0, 0.01, 0.02].flatMap((y) => Array.from(target, (value, k) => value + (k === 13 ? y : 0)));
    assert.deepEqual(arms.solvePath(small, points).q.slice(), kinopt.solvePath(whole, points).q.slice());
    assert.equal(inspect(small), inspect(whole));
    assert.throws(() => new arms.Arm(arms.Robot.fromUrdf(urdf), "base", "elbow"), arms.UnknownNameError);
});

test("exports are those of arms", () => {
    const left = Object.keys(kinopt).filter((name) => !(name in arms));
    for (const name of ["Problem", "Solver", "Drag", "Rig", "Scene", "World", "retarget", "tasks"]) assert.ok(left.includes(name), name);
    for (const name of ["Arm", "Robot", "Srdf", "ForwardKinematics", "Jacobian", "placement", "solvePath"]) assert.ok(name in arms, name);
    assert.deepEqual(Object.keys(arms).filter((name) => !(name in kinopt)), []);
});

test("the download is less than half", () => {
    const size = (name) => gzipSync(readFileSync(new URL(import.meta.resolve(name)))).length;
    assert.ok(size("kinopt/arms/kinopt.wasm") < size("kinopt/kinopt.wasm") / 2);
});
