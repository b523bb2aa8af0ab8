// The package installs from a registry with its archive into an empty project; its README's code runs there, and its
// types are valid.
import assert from "node:assert/strict";
import { execFile, execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, symlinkSync, writeFileSync } from "node:fs";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import { join } from "node:path";
import test, { after, before } from "node:test";
import { fileURLToPath } from "node:url";
import { promisify } from "node:util";
import { model } from "./panda.js";

const packageFolder = fileURLToPath(new URL("..", import.meta.url));
const project = mkdtempSync(join(tmpdir(), "kinopt-"));
const run = (command, ...rest) => execFileSync(command, rest, { cwd: project, encoding: "utf8" });
const readme = readFileSync(join(packageFolder, "README.md"), "utf8");
const blocks = [...readme.matchAll(/```js\n(.*?)```/gs)].map(([, text]) => text);

/** A registry of one package, with the requests of npm: its metadata, and its archive. */
async function registry({ filename, integrity, name, version }) {
    const archive = readFileSync(join(project, filename));
    const server = createServer(({ url }, response) => {
        const address = `http://127.0.0.1:${server.address().port}`;
        const metadata = { ...JSON.parse(readFileSync(join(packageFolder, "package.json"))), dist: { integrity, tarball: `${address}/${filename}` } };
        if (url === `/${filename}`) response.end(archive);
        else if (url === `/${name}`) response.end(JSON.stringify({ name, "dist-tags": { latest: version }, versions: { [version]: metadata } }));
        else response.writeHead(404).end();
    });
    await new Promise((ready) => server.listen(0, "127.0.0.1", ready));
    return server;
}

before(async () => {
    const [archive] = JSON.parse(run("npm", "pack", packageFolder, "--json"));
    writeFileSync(join(project, "package.json"), '{ "type": "module" }');
    const server = await registry(archive);
    const [command, ...words] = readme.match(/<!-- in an empty project -->\n```sh\n(.*)\n```/)[1].split(" ");
    const options = ["--no-audit", "--no-fund", "--registry", `http://127.0.0.1:${server.address().port}`];
    await promisify(execFile)(command, [...words, ...options], { cwd: project });
    server.close();
    for (const name of ["three", "@types"]) symlinkSync(join(packageFolder, "node_modules", name), join(project, "node_modules", name), "junction");
});
after(() => rmSync(project, { recursive: true }));

test("the README's first example runs", () => {
    writeFileSync(join(project, "ten.js"), blocks[0]);
    assert.match(run("node", "ten.js"), /^true Float64Array\(7\)/);
});

test("the README's drag runs", () => {
    // Functions of the reader: file access and drawing.
    const readers = `
        import { readFileSync } from "node:fs";
        const folder = ${JSON.stringify(model("humanoid/").href)};
        const bytes = async (file) => readFileSync(new URL(file, folder));
        const parts = Object.fromEntries(["humanoid.ply", "humanoid.dmat"].map((file) => [file, readFileSync(new URL(file, folder))]));
        let drawn = 0;
        const upload = (positions, normals) => { drawn += positions.length === normals.length && positions.length > 0 ? 1 : 0; };`;
    writeFileSync(join(project, "drag.js"), `${readers}\n${blocks[1]}\nconsole.log(drawn);`);
    assert.equal(run("node", "drag.js"), "60\n");
});

test("the README's retargeting runs", () => {
    const readers = `
        import { readFileSync } from "node:fs";
        const [captures, robots] = ${JSON.stringify([model("captures/").href, model("").href])};
        const bytes = async (file) => readFileSync(new URL(file, captures));
        const text = async (file) => readFileSync(new URL(file, robots), "utf8");
        let moved = 0;
        const move = (robot, q) => { moved += q.length === robot.model.configurationLen ? 1 : 0; };`;
    writeFileSync(join(project, "follow.js"), `${readers}\n${blocks[2]}\nconsole.log(moved);`);
    assert.equal(run("node", "follow.js"), "180\n");
});

test("the README's three.js drag follows the pointer", () => {
    // A canvas of 400 x 300 pixels, and a renderer whose loop the test calls.
    const stage = `
        const listeners = [];
        const canvas = {
            style: {},
            addEventListener: (type, listener) => listeners.push([type, listener]),
            getBoundingClientRect: () => ({ left: 0, top: 0, width: 400, height: 300 }),
            setPointerCapture() {},
        };
        const send = (type, clientX, clientY) => listeners.forEach(([known, listener]) =>
            known === type && listener({ clientX, clientY, pointerId: 1, isPrimary: true, button: 0, buttons: 1 }));
        let frame;
        const renderer = { domElement: canvas, render: () => camera.updateMatrixWorld(), setAnimationLoop: (loop) => (frame = loop) };
        const scene = new THREE.Scene();
        const camera = new THREE.PerspectiveCamera(40, 4 / 3, 0.1, 10);
        camera.up.set(0, 0, 1);
        camera.position.set(0.4, -2, 0.5);
        camera.lookAt(0.4, 0, 0.5);
        camera.updateMatrixWorld();`;
    // Its imports come before the stage.
    const [imports, program] = blocks[3].split("\n\n");
    const end = `
        const pixel = () => { const { x, y } = tool.clone().project(camera); return [200 * (x + 1), 150 * (1 - y)]; };
        frame();
        const [x, y] = pixel();
        send("pointerdown", x + 3, y);
        send("pointermove", x + 25, y - 30);
        send("pointerup", x + 25, y - 30);
        send("pointermove", 0, 0);
        for (let k = 0; k < 60; k += 1) frame();
        const moved = pixel();
        console.log(Math.hypot(moved[0] - x - 25, moved[1] - y + 30) < 0.1, links.children.some((link) => link.children.length > 0));`;
    writeFileSync(join(project, "three.js"), `${imports}\n${stage}\n${program}\n${end}`);
    assert.equal(run("node", "three.js"), "true true\n");
});

test("the package works in a worker with its own module", () => {
    writeFileSync(join(project, "worker.js"), `import { parentPort } from "node:worker_threads";\n${blocks[0]}\nparentPort.postMessage(solution.reached);`);
    writeFileSync(join(project, "main.js"), `import { Worker } from "node:worker_threads";
        const worker = new Worker(new URL("./worker.js", import.meta.url), { stdout: true });
        worker.on("message", (reached) => console.log(reached));`);
    assert.equal(run("node", "main.js"), "true\n");
});

test("a compiled module is accepted", () => {
    writeFileSync(join(project, "bare.js"), `import { readFileSync } from "node:fs";
        import { init, placement, Robot } from "kinopt/bare";
        const url = new URL(import.meta.resolve("kinopt/kinopt.wasm"));
        await init({ module_or_path: await WebAssembly.compile(readFileSync(url)) });
        console.log(Robot.name, placement().length);`);
    assert.equal(run("node", "bare.js"), "Robot 16\n");
});

test("the README's types are valid, wrong types are not", () => {
    const reads = "import type { Robot as Shown } from \"kinopt\"; declare function bytes(file: string): Promise<Uint8Array>;\n" +
        "declare function text(file: string): Promise<string>; declare function move(robot: Shown, q: Float64Array): void;\n";
    const reader = "declare const parts: Record<string, Uint8Array>; declare function bytes(file: string): Promise<Uint8Array>;\n" +
        "declare function upload(positions: Float32Array, normals: Float32Array): void;\n";
    writeFileSync(join(project, "ten.ts"), blocks[0]);
    writeFileSync(join(project, "drag.ts"), reader + blocks[1]);
    writeFileSync(join(project, "follow.ts"), reads + blocks[2]);
    writeFileSync(join(project, "three.ts"), `declare const scene: THREE.Scene; declare const camera: THREE.Camera; declare const renderer: THREE.WebGLRenderer;\n${blocks[3]}`);
    writeFileSync(join(project, "wrong.ts"), `import { Arm, RetargetFollower, Robot, solvePath, tasks } from "kinopt";
        // @ts-expect-error
        new Arm(Robot.fromUrdf(""), "base", "tip", { search: "best" });
        // @ts-expect-error
        tasks.point("tip", "there");
        // @ts-expect-error
        tasks.point("tip", [0, 0, 0], { wieght: 1 });
        // @ts-expect-error
        tasks.bounded({ kind: "hover" }, { lower: 0 });
        // @ts-expect-error
        tasks.posture([0, 1], { jointWeights: "by weight" });
        // @ts-expect-error
        new RetargetFollower(Robot.fromUrdf(""), "clip");
        // @ts-expect-error
        solvePath(new Arm(Robot.fromUrdf(""), "base", "tip"), [0], { traversal: "back" });
        // @ts-expect-error
        new Arm(Robot.fromUrdf(""), "base", "tip").solve(3);`);
    const tsc = join(packageFolder, "node_modules/.bin/tsc");
    const options = ["--noEmit", "--strict", "--target", "es2022", "--module", "nodenext", "--lib", "es2022,dom"];
    try {
        run(tsc, ...options, "ten.ts", "drag.ts", "follow.ts", "three.ts", "wrong.ts");
        // The types need no declarations of a browser or of Node.
        writeFileSync(join(project, "bare.ts"), `import { init, type Robot } from "kinopt/bare";
            export const begun = (module: ArrayBuffer) => init({ module_or_path: module });
            export const nameOf = (robot: Robot) => robot.name;`);
        run(tsc, ...options.slice(0, -1), "es2022", "--types", "", "--skipLibCheck", "false", "bare.ts");
    } catch ({ stdout }) {
        assert.fail(stdout);
    }
});
