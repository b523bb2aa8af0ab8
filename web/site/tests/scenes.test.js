// Scenes of the page without a browser: their code, their own motion, links to their states, and figures of frames.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, mkdirSync, mkdtempSync, rmSync, symlinkSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import test from "node:test";
import { fileURLToPath } from "node:url";
import { CODE } from "../src/code.js";
import { Demo } from "../src/demo.js";
import { SCENES } from "../src/models.js";
import { fragment, stateOf } from "../src/share.js";

const packageFolder = fileURLToPath(new URL("../../", import.meta.url));
const models = fileURLToPath(new URL("../../../models/", import.meta.url));

test("the code of every scene runs, and moves its model", () => {
    const project = mkdtempSync(join(tmpdir(), "kinopt-scenes-"));
    try {
        mkdirSync(join(project, "node_modules"));
        symlinkSync(packageFolder, join(project, "node_modules/kinopt"), "junction");
        // Functions of the reader: files, a drawing that counts different configurations, and a target that moves.
        const reader = `import { readFileSync } from "node:fs";
            const folder = { "humanoid.json": "humanoid/", "humanoid.ply": "humanoid/", "humanoid.dmat": "humanoid/", "steps.bvh": "captures/", "quadruped.urdf": "quadruped/" };
            const bytes = async (name) => readFileSync(${JSON.stringify(models)} + (folder[name] ?? "") + name);
            const text = async (name) => String(await bytes(name));
            const drawn = new Set();
            const draw = (q) => drawn.add(Array.from(q).map((value) => value.toFixed(4)).join());
            const follow = (frame) => { for (let k = 0; k < 20; k += 1) frame([0.4 + 0.005 * k, 0.2, ${"height"}], k / 30); };\n`;
        for (const [scene, code] of Object.entries(CODE)) {
            const file = join(project, `${scene}.mjs`);
            const height = { nao: 0.1, quadruped: -0.05, panda: 0.5 }[scene] ?? 1.1;
            writeFileSync(file, `${reader.replace("height", height)}${code}\nconsole.log(drawn.size > 10);`);
            assert.equal(execFileSync(process.execPath, ["--preserve-symlinks", file], { encoding: "utf8" }), "true\n", scene);
            assert.ok(code.trim().split("\n").length <= 18, scene);
        }
        assert.deepEqual(Object.keys(CODE), Object.keys(SCENES));
    } finally {
        rmSync(project, { recursive: true });
    }
});

test("every scene links to a page of the guide", () => {
    for (const { guide } of Object.values(SCENES)) assert.ok(existsSync(new URL(`../dist/${guide}`, import.meta.url)), guide);
});

test("acts follow each other along closed paths", () => {
    const path = (along) => [Math.sin(2 * Math.PI * along), 0, 0];
    const demo = new Demo([{ handle: "hand", seconds: 1, path }, { handle: "hips", seconds: 2, path }]);
    const frames = Array.from({ length: 130 }, (_, k) => demo.advance(10 + k / 40));
    const starts = frames.flatMap(({ begins, handle }, k) => (begins ? [[k, handle]] : []));
    assert.deepEqual(starts.map(([, handle]) => handle), ["hand", "hips", "hand"]);
    for (const [k] of starts) assert.deepEqual(frames[k].offset, [0, 0, 0]);
    frames.slice(1).forEach(({ offset, begins }, k) => assert.ok(begins || Math.abs(offset[0] - frames[k].offset[0]) < 0.2));
    // A page that was hidden continues without a jump.
    const { offset } = demo.advance(1000);
    assert.ok(Math.abs(offset[0] - frames.at(-1).offset[0]) < 0.35);
    for (const { acts = [] } of Object.values(SCENES)) {
        for (const act of acts) assert.ok(Math.hypot(...act.path(1).map((value, k) => value - act.path(0)[k])) < 1e-9, act.handle);
    }
});

test("an address keeps a scene, a pose and a camera", () => {
    const state = { scene: "nao", q: [0, -0.25, 1.5, 0.1], view: [1, -2, 0.5, 0, 0, 0.75] };
    const back = stateOf(fragment(state));
    assert.equal(back.scene, "nao");
    state.q.forEach((value, k) => assert.ok(Math.abs(back.q[k] - value) < 1e-7));
    assert.deepEqual(back.view, state.view);
    assert.deepEqual(stateOf("#scene=panda"), { scene: "panda", q: undefined, view: undefined });
    assert.equal(stateOf(""), undefined);
    // Damaged numbers open the scene at rest.
    for (const damaged of ["#scene=nao&q=%%%", "#scene=nao&q=abc", "#scene=nao&view=AAAAAA", `#scene=nao&q=${"_".repeat(16)}`]) {
        assert.deepEqual(stateOf(damaged), { scene: "nao" }, damaged);
    }
});
