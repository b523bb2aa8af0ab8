// The page in a real browser, from a plain static server: a hand is dragged along 300 points, an arm goes round boxes, bad
// files are told, nothing is said on the console. KINOPT_PICTURES=FOLDER has it take the pictures of the README.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { join } from "node:path";
import test, { after, before } from "node:test";
import { fileURLToPath } from "node:url";
import { skip, started } from "./browser.js";

const models = fileURLToPath(new URL("../../../models/", import.meta.url));
let site;
let browser;
let address;

before(async () => {
    if (skip) return;
    site = await started();
    ({ browser, address } = site);
});
after(() => site?.close());

/** A page that opened the humanoid, and all that it said on the console. */
async function opened(options) {
    const page = await browser.newPage({ viewport: { width: 900, height: 640 }, colorScheme: "light", ...options });
    const said = [];
    // What software drawing says of itself is no word of the page, nor which version of Collada a file is of.
    page.on("console", (message) => /GPU stall|GL Driver|ColladaLoader: File version/.test(message.text()) || said.push(message.text()));
    page.on("pageerror", (error) => said.push(String(error)));
    await page.goto(address);
    await page.waitForFunction(() => globalThis.kinoptPage?.view);
    return { page, said };
}

const seen = (page, name) =>
    page.evaluate((name) => {
        const { stage, view } = kinoptPage;
        return stage.toScreen(view.place(name));
    }, name);
const status = (page) => page.locator("#status").textContent();
const pictured = (page, name) =>
    process.env.KINOPT_PICTURES && page.screenshot({ path: join(process.env.KINOPT_PICTURES, name) });

async function settled(page) {
    await page.waitForFunction(() => !kinoptPage.busy && !kinoptPage.moved && !kinoptPage.stage.asked);
}

test("a hand is dragged along 300 points", { skip }, async () => {
    const { page, said } = await opened();
    const hand = await seen(page, "left_hand");
    const foot = await page.evaluate(() => kinoptPage.view.place("left_foot").toArray());
    await page.mouse.move(hand.x, hand.y);
    await page.mouse.down();
    for (let k = 1; k <= 300; k += 1) {
        const turn = (2 * Math.PI * k) / 300;
        await page.mouse.move(hand.x - 60 * Math.sin(turn), hand.y - 50 * (1 - Math.cos(turn)));
        await page.waitForTimeout(1000 / 60);
        if (k === 120) await pictured(page, "web-humanoid.png");
    }
    await page.mouse.up();
    await settled(page);
    const frames = await page.evaluate(() => kinoptPage.frames);
    assert.ok(frames.length > 30, `${frames.length} frames`);
    const back = await seen(page, "left_hand");
    assert.ok(Math.hypot(back.x - hand.x, back.y - hand.y) < 4, "the hand comes back with the mouse");
    const held = await page.evaluate(() => kinoptPage.view.place("left_foot").toArray());
    held.forEach((value, k) => assert.ok(Math.abs(value - foot[k]) < 1e-3, "the pinned foot stays"));
    const of = (what) => frames.map(what).sort((a, b) => a - b);
    const both = of(({ solved, posed }) => solved + posed);
    const told = (share) => both[Math.floor(share * (both.length - 1))].toFixed(2);
    console.log(`${frames.length} frames: solving and skin ${told(0.5)} ms in the median, ${told(0.95)} at the 95th percentile`);
    assert.deepEqual(said, []);
    await page.close();
});

test("any joint, pins, keys, both skins, its clip", { skip }, async () => {
    const { page, said } = await opened();
    const at = (name) => page.evaluate((name) => kinoptPage.view.place(name).toArray(), name);
    const canvas = page.locator("#stage");
    await canvas.focus();
    await page.keyboard.press("Tab");
    const name = await page.evaluate(() => kinoptPage.grabbed);
    assert.ok(name);
    const grabbed = await seen(page, "right_hand");
    await page.mouse.click(grabbed.x, grabbed.y);
    assert.equal(await page.evaluate(() => kinoptPage.grabbed), "right_hand");
    const before = await at("right_hand");
    await canvas.focus();
    for (let k = 0; k < 5; k += 1) await page.keyboard.press("ArrowDown");
    await settled(page);
    const after = await at("right_hand");
    assert.ok(after[2] < before[2] - 0.01, `${before} to ${after}`);
    const pins = () => page.evaluate(() => [...kinoptPage.pins]);
    assert.ok((await pins()).includes("right_hand"));
    await page.locator("#pin").click();
    assert.ok(!(await pins()).includes("right_hand"));
    const positions = () => page.evaluate(() => [...kinoptPage.view.geometry.attributes.position.array]);
    const linear = await positions();
    await page.locator("#skin").click();
    await settled(page);
    const dual = await positions();
    assert.ok(dual.some((value, k) => Math.abs(value - linear[k]) > 1e-4));
    await page.locator("#play").click();
    await page.waitForTimeout(400);
    const played = await positions();
    await page.locator("#play").click();
    assert.ok(played.some((value, k) => Math.abs(value - dual[k]) > 1e-3));
    await page.locator("#rest").click();
    await settled(page);
    assert.deepEqual(said, []);
    await page.close();
});

test("a hand is dragged while the clip goes on, is pinned there, and comes back to the clip when it is let go", { skip }, async () => {
    const { page, said } = await opened();
    const at = (name) => page.evaluate((name) => kinoptPage.view.place(name).toArray(), name);
    const away = (a, b) => Math.hypot(...a.map((value, k) => value - b[k]));
    const hand = await seen(page, "left_hand");
    const begun = await at("left_hand");
    await page.locator("#play").click();
    await page.waitForFunction(() => kinoptPage.playback.running);
    await page.mouse.move(hand.x, hand.y);
    await page.mouse.down();
    for (let k = 1; k <= 60; k += 1) {
        await page.mouse.move(hand.x - k, hand.y - 2 * k);
        await page.waitForTimeout(1000 / 60);
        if (k === 50) await pictured(page, "web-over-clip.png");
    }
    const target = await page.evaluate(() => kinoptPage.target.toArray());
    await page.waitForFunction((target) => kinoptPage.view.place("left_hand").toArray().every((value, k) => Math.abs(value - target[k]) < 0.01), target);
    // The other hand waves on, from frame to frame.
    const waving = [];
    for (let k = 0; k < 8; k += 1) {
        waving.push(await at("right_hand"));
        await page.waitForTimeout(150);
    }
    assert.ok(Math.max(...waving.map((place) => away(place, waving[0]))) > 0.03, "the clip goes on");
    await page.locator("#stage").focus();
    await page.keyboard.press("p");
    await page.mouse.up();
    await page.waitForTimeout(700);
    assert.ok(away(await at("left_hand"), target) < 0.01, "a pinned hand stays");
    await page.keyboard.press("p");
    await page.waitForFunction((begun) => Math.hypot(...kinoptPage.view.place("left_hand").toArray().map((value, k) => value - begun[k])) < 0.05, begun);
    const frames = await page.evaluate(() => kinoptPage.frames.map(({ solved }) => solved).sort((a, b) => a - b));
    console.log(`${frames.length} frames over the clip: ${frames[frames.length >> 1].toFixed(2)} ms in the median`);
    // The keyboard holds too.
    await page.keyboard.press("ArrowUp");
    assert.ok(await page.evaluate(() => kinoptPage.nudged && kinoptPage.grabbed === "left_hand"));
    await page.keyboard.press("Escape");
    assert.equal(await page.evaluate(() => kinoptPage.grabbed), undefined);
    await page.locator("#play").click();
    assert.deepEqual(said, []);
    await page.close();
});

test("a robot follows a captured person live, another one that is dropped, and as a whole", { skip }, async () => {
    const { page, said } = await opened();
    await page.locator('[data-open="capture"]').click();
    await page.waitForFunction(() => kinoptPage.opened?.kind === "movement" && kinoptPage.frames.length > 20, undefined, { timeout: 60_000 });
    const state = () => page.evaluate(() => ({
        robot: kinoptPage.view.links.map(({ matrix }) => matrix.elements.slice(12, 15)).flat(),
        person: kinoptPage.view.person && [...kinoptPage.view.person],
    }));
    const before = await state();
    assert.ok(before.robot.every(Number.isFinite) && before.person.every(Number.isFinite));
    await page.waitForTimeout(500);
    if (process.env.KINOPT_PICTURES) await page.waitForFunction(() => Math.abs(kinoptPage.playback.seconds - 5.3) < 0.2);
    await pictured(page, "web-capture.png");
    const later = await state();
    const moved = (a, b) => Math.max(...a.map((value, k) => Math.abs(value - b[k])));
    assert.ok(moved(before.robot, later.robot) > 0.005 && moved(before.person, later.person) > 0.005);
    await page.locator("#play").click();
    await page.waitForTimeout(200);
    const still = await state();
    await page.waitForTimeout(300);
    assert.deepEqual(await state(), still);
    await page.locator("#play").click();
    const steps = await page.evaluate(() => kinoptPage.frames.filter(({ steps }) => steps > 0).map(({ solved, steps }) => solved / steps).sort((a, b) => a - b));
    console.log(`${steps.length} answers: ${steps[steps.length >> 1].toFixed(2)} ms a captured frame in the median`);

    await page.locator("#whole").click();
    await page.waitForFunction(() => kinoptPage.whole !== undefined, undefined, { timeout: 120_000 });
    assert.match(await status(page), /mm off in the mean/);
    const { slip } = await page.evaluate(() => kinoptPage.whole);
    assert.ok(slip < 0.01);
    await page.locator("#whole").click();
    await page.waitForFunction(() => kinoptPage.whole === undefined);

    // One's own, whose movement as a whole takes long: it tells how far it is, what plays goes on, and it is stopped.
    const capture = await readFile(join(models, "captures/steps.bvh"), "utf8");
    const [head, motion] = capture.split(/Frame Time: .*\n/);
    const long = `${head.replace(/Frames: \d+/, `Frames: ${181 * 200}`)}Frame Time: 0.0333333\n${motion.repeat(200)}`;
    const file = (name, text) => ({ name, mimeType: "text/plain", buffer: Buffer.from(text) });
    await page.locator("#file").setInputFiles([file("mine.bvh", long)]);
    await page.waitForFunction(() => kinoptPage.opened.seconds > 300, undefined, { timeout: 60_000 });
    assert.equal(await page.evaluate(() => kinoptPage.opened.kind), "movement", "it is on the robot that was shown");
    await page.locator("#whole").click();
    await page.waitForFunction(() => /\d+ of 36200 frames/.test(document.querySelector("#status").textContent), undefined, { timeout: 120_000 });
    const [from, count] = [await state(), await page.evaluate(() => kinoptPage.frames.length)];
    await page.waitForFunction((count) => kinoptPage.frames.length > count + 5, count);
    assert.ok(moved(from.robot, (await state()).robot) > 0.001, "live goes on");
    await page.locator("#stop").click();
    await page.waitForFunction(() => document.querySelector("#status").textContent === "Stopped.");
    assert.ok(await page.locator("#stop").isHidden());
    assert.equal(await page.evaluate(() => kinoptPage.opened.kind), "movement");

    // What is no person's is told, and what was there goes on.
    await page.locator("#file").setInputFiles([file("rope.bvh", "HIERARCHY\nROOT a {\nOFFSET 0 0 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nEnd Site {\nOFFSET 0 1 0\n}\n}\nMOTION\nFrames: 1\nFrame Time: 0.1\n0 0 0\n")]);
    await page.waitForFunction(() => document.querySelector("#status.bad"));
    const told = await status(page);
    assert.match(told, /body/);
    const shown = await page.evaluate(() => kinoptPage.frames.length);
    await page.waitForFunction((shown) => kinoptPage.frames.length > shown + 5, shown);
    assert.equal(await status(page), told, "the words stay to be read");
    assert.deepEqual(said, []);
    await page.close();
});

test("an arm's tool follows among boxes and touches none", { skip }, async () => {
    const { page, said } = await opened();
    await page.locator('[data-open="panda"]').click();
    await page.waitForFunction(() => kinoptPage.opened?.kind === "robot", undefined, { timeout: 60_000 });
    await page.waitForTimeout(200);
    const tool = await seen(page, "flange");
    await page.mouse.move(tool.x, tool.y);
    await page.mouse.down();
    for (let k = 1; k <= 90; k += 1) {
        await page.mouse.move(tool.x - k, tool.y + 2 * k);
        await page.waitForTimeout(1000 / 60);
    }
    await page.mouse.up();
    await settled(page);
    await pictured(page, "web-panda.png");
    const low = await page.evaluate(() => kinoptPage.view.place("flange").z);
    assert.ok(low > 0.14, `the flange stops above the table, at ${low} m`);
    const frames = await page.evaluate(() => kinoptPage.frames.map(({ solved }) => solved).sort((a, b) => a - b));
    console.log(`${frames.length} steps: ${frames[frames.length >> 1].toFixed(2)} ms in the median`);
    assert.deepEqual(said, []);
    await page.close();
});

test("files are chosen, and bad ones are told in the library's words", { skip }, async () => {
    const { page, said } = await opened();
    const choose = async (...files) => page.locator("#file").setInputFiles(files);
    const file = (name, text) => ({ name, mimeType: "text/plain", buffer: Buffer.from(text) });
    const panda = await readFile(join(models, "franka_panda.urdf"), "utf8");
    await choose(file("odd.urdf", panda.replace('type="revolute"', 'type="rotating"')));
    await page.waitForFunction(() => document.querySelector("#status.bad"));
    assert.match(await status(page), /odd\.urdf.*rotating/s);
    assert.equal(await page.evaluate(() => kinoptPage.opened.kind), "character", "what was open stays");
    await choose(file("notes.txt", "nothing"));
    await page.waitForFunction(() => /notes\.txt/.test(document.querySelector("#status").textContent));
    await choose(join(models, "universal_ur5e.urdf"));
    await page.waitForFunction(() => kinoptPage.opened.kind === "robot");
    await choose(...["json", "ply", "dmat"].map((kind) => join(models, `humanoid/humanoid.${kind}`)));
    await page.waitForFunction(() => kinoptPage.opened.kind === "character");
    const walk = `HIERARCHY\nROOT hips {\nOFFSET 0 90 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nJOINT knee {\nOFFSET 0 -45 0
        CHANNELS 3 Zrotation Xrotation Yrotation\nJOINT foot {\nOFFSET 0 -45 0\nCHANNELS 3 Zrotation Xrotation Yrotation
        End Site {\nOFFSET 0 0 15\n}\n}\n}\n}\nMOTION\nFrames: 2\nFrame Time: 0.5\n0 0 0 0 0 0 0 0 0\n0 0 0 0 40 0 0 0 0\n`;
    await choose(file("walk.bvh", walk));
    await page.waitForFunction(() => kinoptPage.opened.handles.includes("knee"));
    const foot = await seen(page, "foot");
    await page.mouse.move(foot.x, foot.y);
    await page.mouse.down();
    await page.mouse.move(foot.x + 40, foot.y - 40, { steps: 10 });
    await page.mouse.up();
    await settled(page);
    const moved = await seen(page, "foot");
    assert.ok(Math.hypot(moved.x - foot.x, moved.y - foot.y) > 10);
    assert.deepEqual(said, []);
    await page.close();
});

test("a robot's meshes are drawn of the files beside it, a scene in its own colours", { skip }, async () => {
    const { page, said } = await opened();
    const file = (name, text) => ({ name, mimeType: "text/plain", buffer: Buffer.from(text) });
    const corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0]];
    const stl = `solid s\nfacet normal 0 0 1\nouter loop\n${corners.map((at) => `vertex ${at.join(" ")}`).join("\n")}\nendloop\nendfacet\nendsolid s\n`;
    const obj = `${corners.map((at) => `v ${at.join(" ")}`).join("\n")}\nf 1 2 3\n`;
    const dae = `<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><up_axis>Z_UP</up_axis></asset>
        <library_geometries><geometry id="g"><mesh><source id="p"><float_array id="a" count="9">0 0 0 1 0 0 0 1 0</float_array>
        <technique_common><accessor source="#a" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
        </accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="1">
        <input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry></library_geometries><library_visual_scenes>
        <visual_scene id="s"><node><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>`;
    const link = (name, mesh) => `<link name="${name}"><visual><origin xyz="0 0 0.5"/><geometry><mesh filename="package://arm/meshes/${mesh}" scale="0.1 0.1 0.1"/></geometry></visual></link>`;
    const joint = (parent, child) => `<joint name="${child}_joint" type="revolute"><parent link="${parent}"/><child link="${child}"/><origin xyz="0 0 1"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>`;
    const urdf = `<robot name="arm">${link("a", "a.stl")}${link("b", "b.obj")}${link("c", "c.dae")}${link("d", "lost.stl")}${joint("a", "b")}${joint("b", "c")}${joint("c", "d")}</robot>`;
    await page.locator("#file").setInputFiles([file("arm.urdf", urdf), file("a.stl", stl), file("b.obj", obj), file("c.dae", dae)]);
    await page.waitForFunction(() => kinoptPage.opened.kind === "robot");
    const drawn = await page.evaluate(async () => {
        await kinoptPage.view.dressed;
        return kinoptPage.view.links.map((link) => {
            let found;
            link.traverse((part) => (found = part.geometry ? part : found));
            found?.updateWorldMatrix(true, false);
            return found && { corner: [...found.geometry.attributes.position.array.slice(3, 6)], scale: found.matrixWorld.getMaxScaleOnAxis() };
        });
    });
    for (const part of drawn.slice(0, 3)) {
        assert.deepEqual(part.corner, [1, 0, 0]);
        assert.ok(Math.abs(part.scale - 0.1) < 1e-6);
    }
    assert.equal(drawn[3], undefined);
    assert.match(await status(page), /1 meshes were not dropped.*lost\.stl/);
    assert.deepEqual(await page.evaluate(() => kinoptPage.view.limbs.pairs), [[0, 1], [1, 2], [2, 3]], "sticks stand for what is missing");

    const numbers = [new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]), new Float32Array([0, 0, 1, 0, 0, 1])];
    const data = Buffer.concat(numbers.map(({ buffer }) => Buffer.from(buffer))).toString("base64");
    const red = "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8z8BQDwAEhQGAhKmMIQAAAABJRU5ErkJggg==";
    const scene = {
        asset: { version: "2.0" }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0 }],
        meshes: [{ primitives: [{ attributes: { POSITION: 0, TEXCOORD_0: 1 }, material: 0 }] }],
        materials: [{ pbrMetallicRoughness: { baseColorFactor: [0.2, 0.4, 0.6, 1], baseColorTexture: { index: 0 } } }],
        textures: [{ source: 0 }], images: [{ uri: "skin.png" }],
        buffers: [{ uri: `data:application/octet-stream;base64,${data}`, byteLength: 60 }],
        bufferViews: [{ buffer: 0, byteOffset: 0, byteLength: 36 }, { buffer: 0, byteOffset: 36, byteLength: 24 }],
        accessors: [{ bufferView: 0, componentType: 5126, count: 3, type: "VEC3", min: [0, 0, 0], max: [1, 1, 0] },
            { bufferView: 1, componentType: 5126, count: 3, type: "VEC2" }],
    };
    await page.locator("#file").setInputFiles([file("leaf.gltf", JSON.stringify(scene)), { name: "skin.png", mimeType: "image/png", buffer: Buffer.from(red, "base64") }]);
    await page.waitForFunction(() => kinoptPage.opened.kind === "character" && Array.isArray(kinoptPage.view.skin?.material));
    const look = await page.evaluate(() => {
        const [{ color, map }] = kinoptPage.view.skin.material;
        return { color: color.toArray(), pixels: map.image.width, uv: [...kinoptPage.view.geometry.attributes.uv.array] };
    });
    [0.2, 0.4, 0.6].forEach((value, k) => assert.ok(Math.abs(look.color[k] - value) < 1e-6));
    assert.equal(look.pixels, 1);
    assert.deepEqual(look.uv, [0, 0, 1, 0, 0, 1]);
    assert.deepEqual(said, []);
    await page.close();
});

test("what takes long is stopped, and what was open is there again", { skip }, async () => {
    const { page, said } = await opened();
    await page.evaluate(() => {
        const joints = Array.from({ length: 60 }, (_, k) => `JOINT j${k} {\nOFFSET 0 1 0\nCHANNELS 3 Zrotation Xrotation Yrotation\n`);
        const head = `HIERARCHY\nROOT r {\nOFFSET 0 0 0\nCHANNELS 3 Zrotation Xrotation Yrotation\n${joints.join("")}End Site {\nOFFSET 0 1 0\n}\n`;
        const frames = 80_000;
        const text = `${head}${"}\n".repeat(61)}MOTION\nFrames: ${frames}\nFrame Time: 0.01\n${`${"0.5 ".repeat(183)}\n`.repeat(frames)}`;
        const dataTransfer = new DataTransfer();
        dataTransfer.items.add(new File([text], "long.bvh"));
        dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true }));
    });
    await page.locator("#stop").click();
    await page.waitForFunction(() => document.querySelector("#status").textContent === "Stopped.");
    await page.waitForFunction(() => document.querySelector("#stop").hidden);
    const hand = await seen(page, "left_hand");
    await page.mouse.move(hand.x, hand.y);
    await page.mouse.down();
    await page.mouse.move(hand.x - 30, hand.y + 60, { steps: 20 });
    await page.mouse.up();
    await settled(page);
    const moved = await seen(page, "left_hand");
    assert.ok(Math.hypot(moved.x - hand.x, moved.y - hand.y) > 20);
    assert.deepEqual(said, []);
    await page.close();
});

test("a finger drags on a small screen, where nothing is wider than it", { skip }, async () => {
    const { page, said } = await opened({ viewport: { width: 360, height: 640 }, hasTouch: true, isMobile: true });
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= 360));
    const hand = await seen(page, "left_hand");
    const touch = await page.context().newCDPSession(page);
    const send = (type, x, y) => touch.send("Input.dispatchTouchEvent", { type, touchPoints: type === "touchEnd" ? [] : [{ x, y }] });
    await send("touchStart", hand.x, hand.y);
    for (let k = 1; k <= 30; k += 1) await send("touchMove", hand.x - k, hand.y + k);
    await send("touchEnd");
    await settled(page);
    const moved = await seen(page, "left_hand");
    assert.ok(Math.hypot(moved.x - hand.x, moved.y - hand.y) > 20, `${moved.x - hand.x}, ${moved.y - hand.y}`);
    await pictured(page, "web-small.png");
    assert.deepEqual(said, []);
    await page.close();
});
