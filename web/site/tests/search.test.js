// The search of the documentation.
import assert from "node:assert/strict";
import test from "node:test";
import { indexed, ranked } from "../docs/search.js";

const SECTIONS = [
    ["Changelog", "0.1.0", "changelog.html#1", "paths: solve_path keeps the start. servo: joint limits."],
    ["Paths", "Solving a path", "docs/guide/paths.html#1", "arm.solve_path(points) solves a Cartesian path."],
    ["kinopt for Python", "Arm", "python/reference.html#arm", "def solve_path(self, path, start=None)"],
    ["Web", "Arm", "web/reference.html#arm", "solvePath(path: Path): JointPath"],
    ["Servo", "Servoing", "docs/guide/servo.html#1", "A servo follows targets at 1 kHz within limits."],
    ["Arms", "A first pose", "docs/guide/arms.html#1", "Inverse kinematics of an arm."],
];
const INDEX = indexed(SECTIONS);
const addresses = (query) => ranked(INDEX, query).map(({ address }) => address);

test("guides come before references, and both before the changelog", () => {
    const found = addresses("solve_path");
    assert.equal(found[0], "docs/guide/paths.html#1");
    assert.equal(found.at(-1), "changelog.html#1");
});

test("names of methods are found in the spelling of each language", () => {
    for (const query of ["solve_path", "solvePath", "solvepath"]) {
        const found = addresses(query);
        assert.ok(found.includes("python/reference.html#arm") && found.includes("web/reference.html#arm"), query);
    }
});

test("synonyms are found", () => {
    assert.deepEqual(addresses("ik arm"), ["docs/guide/arms.html#1"]);
    assert.equal(addresses("teleoperation")[0], "docs/guide/servo.html#1");
});

test("all words must match", () => {
    assert.deepEqual(addresses("servo quaternion"), []);
    assert.deepEqual(addresses(" "), []);
});
