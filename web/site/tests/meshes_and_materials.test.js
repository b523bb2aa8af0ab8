// A robot is drawn with the meshes that are dropped with it, and a scene with its materials.
import assert from "node:assert/strict";
import { join } from "node:path";
import test, { after, before } from "node:test";
import { skip } from "./browser.js";
import { file, status, visiting } from "./visit.js";

const { opened, begin, end } = visiting();
before(begin);
after(end);

test("dropped meshes and scene materials are drawn", { skip }, async () => {
    const { page, consoleMessages } = await opened();
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
    assert.match(await status(page), /1 meshes are missing.*lost\.stl/);
    assert.deepEqual(await page.evaluate(() => kinoptPage.view.limbs.pairs), [[0, 1], [1, 2], [2, 3]], "sticks replace missing meshes");

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
    assert.deepEqual(consoleMessages, []);
    await page.close();
});
