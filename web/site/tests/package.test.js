// The package in a browser without a bundler: the README's example, and a hundred humanoids dragged at once. The site
// by the commands of the project's README.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import test, { after, before } from "node:test";
import { fileURLToPath } from "node:url";
import { skip, started } from "./browser.js";

const packageFolder = new URL("../../", import.meta.url);
const project = mkdtempSync(join(tmpdir(), "kinopt-page-"));
const readme = readFileSync(new URL("README.md", packageFolder), "utf8");
const block = (language) => readme.match(new RegExp(`\`\`\`${language}\\n(.*?)\`\`\``, "s"))[1];
let site;

before(async () => {
    if (skip) return;
    cpSync(fileURLToPath(new URL("dist", packageFolder)), join(project, "node_modules/kinopt/dist"), { recursive: true });
    cpSync(fileURLToPath(new URL("../models/humanoid", packageFolder)), join(project, "humanoid"), { recursive: true });
    site = await started({ folder: `${project}/` });
});
after(async () => {
    await site?.close();
    rmSync(project, { recursive: true });
});

/** Text of a page with this script once it matches. */
async function pageText(name, script, last) {
    writeFileSync(join(project, name), `<!doctype html><link rel="icon" href="data:,">${block("html")}<script type="module">\n${script}</script>`);
    const page = await site.browser.newPage();
    const words = [];
    page.on("console", (message) => words.push(message.text()));
    page.on("pageerror", (error) => words.push(String(error)));
    await page.goto(site.address + name);
    for (let tries = 0; tries < 600 && !words.some((word) => last.test(word)); tries += 1) await page.waitForTimeout(100);
    await page.close();
    return words;
}

test("the README's first example runs in a page", { skip }, async () => {
    const [word, ...more] = await pageText("ten.html", block("js"), /./);
    assert.match(word, /^true Float64Array\(7\)/);
    assert.deepEqual(more, []);
});

test("a hundred humanoids are dragged with pinned tips", { skip }, async () => {
    const script = `
        import { Drag, ForwardKinematics, Problem, Rig, tasks } from "kinopt";
        const bytes = async (file) => new Uint8Array(await (await fetch("humanoid/" + file)).arrayBuffer());
        const parts = { "humanoid.ply": await bytes("humanoid.ply"), "humanoid.dmat": await bytes("humanoid.dmat") };
        const rig = Rig.parse(await bytes("humanoid.json"), "humanoid.json", (file) => parts[file]);
        const rest = rig.model.neutral();
        const tips = rig.constrained.map((bone) => rig.skeleton.tip(bone));
        const at = new ForwardKinematics(rig.model, tips).place(rest).slice();
        const positionOf = (k) => [...at.slice(16 * k + 12, 16 * k + 15)];
        const pins = rig.constrained.map((name, k) => tasks.point(tips[k], positionOf(k), { name }));
        const [x, y, z] = positionOf(rig.constrained.indexOf("left_hand"));
        const crowd = Array.from({ length: 100 }, () => new Drag(new Problem(rig.model, pins), rest));
        const times = [];
        let reached = 0;
        for (let frame = 0; frame < 300; frame += 1) {
            const begun = performance.now();
            for (const [k, drag] of crowd.entries()) {
                const turn = (2 * Math.PI * (frame + 3 * k)) / 300;
                const down = 1 - Math.cos(turn);
                const solution = drag.advance({ left_hand: [x + 0.1 * Math.sin(turn), y - 0.15 * down, z - 0.1 * down] });
                reached += solution.reached ? 1 : 0;
                solution.free();
            }
            times.push(performance.now() - begun);
        }
        times.sort((a, b) => a - b);
        console.log(JSON.stringify({ median: times[150], late: times[285], reached }));`;
    const [word, ...more] = await pageText("hundred.html", script, /./);
    assert.deepEqual(more, []);
    const { median, late, reached } = JSON.parse(word);
    console.log(`a hundred humanoids, a frame of each: ${median.toFixed(1)} ms in the median, ${late.toFixed(1)} at the 95th percentile`);
    assert.ok(reached > 0.95 * 30_000, `${reached} of 30 000 frames reached`);
});

test("the command of the project's README serves the site", async () => {
    const root = fileURLToPath(new URL("../", packageFolder));
    const [, line] = readFileSync(join(root, "README.md"), "utf8").match(/<!-- until its page answers -->\n```sh\n(.*)\n```/);
    const [build, serve] = line.split(" && ");
    // The build under test is the result of this command.
    assert.equal(build, "web/site/build");
    const [command, ...words] = serve.split(" ");
    // Any free port.
    const server = spawn(command, ["-u", ...words, "0"], { cwd: root });
    try {
        // The output arrives in pieces of any size.
        let printed = "";
        const port = await new Promise((resolve) =>
            server.stdout.on("data", (text) => {
                printed += text;
                const match = /port (\d+)\b./.exec(printed);
                if (match) {
                    resolve(match[1]);
                }
            }),
        );
        const page = await fetch(`http://127.0.0.1:${port}/`);
        assert.match(await page.text(), /<title>.*kinopt/i);
    } finally {
        server.kill();
    }
});
