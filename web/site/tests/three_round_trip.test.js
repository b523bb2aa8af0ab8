// Promise: a scene file with an added clip is the same scene for other programs. Khronos' validator finds no error,
// three.js draws an equal picture and plays the clip as kinopt does. A file written by three.js is read back.
import assert from "node:assert/strict";
import test, { after, before } from "node:test";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";
import { validateBytes } from "gltf-validator";
import { Recording, Scene, SceneFile } from "../../dist/node.js";
import { skip, started } from "./browser.js";

let site, page;
const consoleMessages = [];

before(async () => {
    if (skip) return;
    const entryPoints = [fileURLToPath(new URL("three_scene.js", import.meta.url))];
    const { outputFiles } = await build({ entryPoints, bundle: true, write: false, format: "iife", globalName: "threeScene" });
    site = await started();
    page = await site.browser.newPage();
    page.on("console", (message) => message.type() === "error" && consoleMessages.push(message.text()));
    await page.route("**/blank.html", (route) => route.fulfill({ contentType: "text/html", body: "<!doctype html><title>three</title>" }));
    await page.goto(`${site.address}blank.html`);
    await page.addScriptTag({ content: outputFiles[0].text });
});

after(() => site?.close());

/** Result of three.js. */
const three = (name, bytes, ...rest) => page.evaluate(([name, bytes, rest]) => threeScene[name](bytes, ...rest), [name, [...bytes], rest]);

const IMAGE = "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8z8BQDwAEhQGAhKmMIQAAAABJRU5ErkJggg==";

/** A coloured, textured strip of two squares on two bones, with a camera, extras and an unknown extension. */
function strip() {
    const rows = [0, 1, 2];
    const parts = [
        [new Float32Array(rows.flatMap((y) => [-0.5, y, 0, 0.5, y, 0])), "VEC3", 5126],
        [new Float32Array(rows.flatMap(() => [0, 0, 1, 0, 0, 1])), "VEC3", 5126],
        [new Float32Array(rows.flatMap((y) => [0, y / 2, 1, y / 2])), "VEC2", 5126],
        [new Float32Array(rows.flatMap((y) => [1, y / 2, 0, 1, 1, 0.5, y / 2, 1])), "VEC4", 5126],
        [new Uint8Array(rows.flatMap((y) => [y > 1, 0, 0, 0, y > 1, 0, 0, 0].map(Number))), "VEC4", 5121],
        [new Float32Array(rows.flatMap(() => [1, 0, 0, 0, 1, 0, 0, 0])), "VEC4", 5126],
        [new Uint16Array([0, 1, 3, 0, 3, 2, 2, 3, 5, 2, 5, 4]), "SCALAR", 5123],
        [new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1]), "MAT4", 5126],
    ];
    const widths = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4, MAT4: 16 };
    let byteOffset = 0;
    const bufferViews = parts.map(([{ byteLength }]) => {
        const view = { buffer: 0, byteOffset, byteLength };
        byteOffset += byteLength;
        return view;
    });
    const accessors = parts.map(([numbers, type, componentType], bufferView) => ({ bufferView, componentType, count: numbers.length / widths[type], type }));
    Object.assign(accessors[0], { min: [-0.5, 0, 0], max: [0.5, 2, 0] });
    const data = Buffer.concat(parts.map(([{ buffer }]) => Buffer.from(buffer)));
    return Buffer.from(JSON.stringify({
        asset: { version: "2.0", extras: { author: "nobody" } },
        extensionsUsed: ["VENDOR_unknown"],
        scene: 0,
        scenes: [{ nodes: [0, 2, 4] }],
        nodes: [
            { name: "low", children: [1] },
            { name: "high", translation: [0, 1, 0], children: [3], extras: { kept: [1, 2] } },
            { name: "skin", mesh: 0, skin: 0 },
            { name: "end", translation: [0, 1, 0] },
            { name: "eye", camera: 0, translation: [0, 0, 5] },
        ],
        cameras: [{ type: "perspective", perspective: { yfov: 0.7, znear: 0.1 } }],
        skins: [{ joints: [0, 1], inverseBindMatrices: 7 }],
        meshes: [{ primitives: [{ attributes: { POSITION: 0, NORMAL: 1, TEXCOORD_0: 2, COLOR_0: 3, JOINTS_0: 4, WEIGHTS_0: 5 }, indices: 6, material: 0 }] }],
        materials: [{ name: "leaf", doubleSided: true, pbrMetallicRoughness: { baseColorTexture: { index: 0 }, metallicFactor: 0 }, extensions: { VENDOR_unknown: { depth: 3 } } }],
        textures: [{ source: 0 }],
        images: [{ mimeType: "image/png", uri: `data:image/png;base64,${IMAGE}` }],
        buffers: [{ byteLength: byteOffset, uri: `data:application/octet-stream;base64,${data.toString("base64")}` }],
        bufferViews,
        accessors,
    }));
}

/** The strip with a clip in which it bends by 1.2 radians in a second. */
function bent() {
    const bytes = strip();
    const file = SceneFile.fromBytes(bytes, "strip.gltf");
    const { armature } = file;
    const figure = Scene.fromBytes(bytes, "strip.gltf").figure(armature.rest);
    const { model } = figure.skeleton;
    const bend = model.jointNames.indexOf("high/bend");
    assert.ok(bend >= 0, `${model.jointNames}`);
    const recording = new Recording(armature, 20);
    for (let k = 0; k <= 20; k += 1) {
        const q = model.neutral();
        q[bend] = 0.06 * k;
        recording.add(figure.toPose(q));
    }
    file.addClip(recording.clip("bend"));
    return { bytes, amended: file.toBytes() };
}

const close = (one, other, within) => one.every((value, k) => Math.abs(value - other[k]) <= within);

test("Khronos' validator finds no error in the file", async () => {
    const { bytes, amended } = bent();
    for (const file of [bytes, amended]) {
        const { issues } = await validateBytes(new Uint8Array(file));
        assert.equal(issues.numErrors, 0, JSON.stringify(issues.messages));
    }
    // All previous content is unchanged.
    const [before, now] = [bytes, amended].map((file) => JSON.parse(new TextDecoder().decode(file)));
    for (const part of ["asset", "scenes", "nodes", "cameras", "skins", "meshes", "materials", "textures", "images", "extensionsUsed"]) {
        assert.deepEqual(now[part], before[part], part);
    }
});

test("three.js draws an equal picture, and a bent one", { skip }, async () => {
    const { bytes, amended } = bent();
    const pictures = [await three("picture", bytes), await three("picture", amended), await three("picture", amended, "bend", 1)];
    const drawn = (picture) => picture.filter((value, k) => k % 4 < 3 && value > 0).length;
    assert.ok(drawn(pictures[0]) > 500, `${drawn(pictures[0])} of the picture is drawn`);
    assert.deepEqual(pictures[1], pictures[0]);
    assert.notDeepEqual(pictures[2], pictures[0]);
    assert.deepEqual(consoleMessages, []);
});

test("three.js plays the clip equally and writes it back", { skip }, async () => {
    const { amended } = bent();
    const exported = Uint8Array.from(await three("written", amended));
    const { issues } = await validateBytes(exported);
    assert.equal(issues.numErrors, 0, JSON.stringify(issues.messages));
    const back = Scene.fromBytes(exported, "exported.glb");
    const scene = Scene.fromBytes(amended, "amended.gltf");
    for (const seconds of [0, 0.33, 1]) {
        const theirs = await three("placements", amended, "bend", seconds);
        for (const someScene of [scene, back]) {
            const [clip] = someScene.clips;
            const placed = someScene.armature.localToModel(clip.sample(seconds));
            for (const bone of ["low", "high", "end"]) {
                const at = someScene.armature.names.indexOf(bone);
                assert.ok(close(placed.slice(16 * at, 16 * at + 16), theirs[bone], 2e-6), `${bone} at ${seconds} s`);
            }
        }
    }
});
