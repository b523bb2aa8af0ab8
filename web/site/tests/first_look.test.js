// First view of the page: the whole model on any screen, and a message if nothing can be drawn.
import assert from "node:assert/strict";
import { join } from "node:path";
import test, { after, before } from "node:test";
import { fileURLToPath } from "node:url";
import { skip, started } from "./browser.js";
import { postered } from "./visit.js";

const models = fileURLToPath(new URL("../../../models/", import.meta.url));
let site;

before(async () => {
    if (!skip) site = await started();
});
after(() => site?.close());

async function opened(browser, options) {
    const page = await browser.newPage({ viewport: { width: 900, height: 640 }, reducedMotion: "reduce", ...options });
    await page.goto(site.address);
    return page;
}

/** Largest distance of the drawing beyond the picture, in pixels, by the corners of each part's box. */
const beyond = (page) =>
    page.evaluate(() => {
        const { stage, view, pointer } = kinoptPage;
        const { left, top, right, bottom } = stage.canvas.getBoundingClientRect();
        view.group.updateMatrixWorld(true);
        let largestExcess = 0;
        view.group.traverse((part) => {
            if (!part.isMesh || part.isInstancedMesh || [view.grid, view.marks].includes(part.parent)) return;
            const { position } = part.geometry.attributes;
            for (let k = 0; k < position.count; k += 1) {
                const corner = stage.camera.position.clone().fromBufferAttribute(position, k).applyMatrix4(part.matrixWorld);
                const { x, y } = pointer.toScreen(corner);
                largestExcess = Math.max(largestExcess, left - x, x - right, top - y, y - bottom);
            }
        });
        return largestExcess;
    });

const SCREENS = [
    ["a desk's", { width: 1280, height: 800 }, "poster.webp"],
    ["a telephone's", { width: 390, height: 844 }, "poster-tall.webp"],
    ["a telephone's on its side", { width: 844, height: 390 }],
];
for (const [screen, viewport, poster] of SCREENS) {
    test(`the whole model is visible on ${screen} screen`, { skip }, async () => {
        const page = await opened(site.browser, { viewport });
        await page.waitForFunction(() => globalThis.kinoptPage?.view);
        assert.equal(await beyond(page), 0, "the humanoid");
        if (poster) await postered(page, poster);
        const [lowest, ground] = await page.evaluate(() => {
            const { positions, base } = kinoptPage.opened;
            return [base[2] + positions.filter((_, k) => k % 3 === 2).reduce((lowestSoFar, z) => Math.min(lowestSoFar, z)), kinoptPage.view.grid.position.z];
        });
        assert.ok(Math.abs(lowest - ground) < 2e-3, `it is on the ground at ${ground} m, not ${lowest} m`);
        assert.match(await page.locator("#hint").innerText(), /Drag any joint/);
        await page.locator('[data-open="panda"]').click();
        await page.waitForFunction(() => kinoptPage.opened.kind === "robot", undefined, { timeout: 60_000 });
        assert.equal(await beyond(page), 0, "the arm and its boxes");
        await page.locator("#file").setInputFiles(join(models, "aldebaran_nao.urdf"));
        await page.waitForFunction(() => kinoptPage.opened.handles.includes("left_sole"), undefined, { timeout: 60_000 });
        assert.equal(await beyond(page), 0, "a dropped robot");
        await page.close();
    });
}

test("a corrected file is chosen again by its name", { skip }, async () => {
    const page = await opened(site.browser);
    await page.waitForFunction(() => globalThis.kinoptPage?.view);
    await page.locator("#file").setInputFiles({ name: "a.urdf", mimeType: "text/plain", buffer: Buffer.from("<robot") });
    await page.waitForFunction(() => document.querySelector("#status.bad"));
    assert.equal(await page.locator("#file").evaluate((input) => input.files.length), 0);
    await page.close();
});

test("a browser without WebGL gets a message", { skip }, async () => {
    const { browser, address, close } = await started({ args: ["--disable-3d-apis"] });
    const page = await browser.newPage();
    await page.goto(address);
    await page.waitForFunction(() => document.querySelector("#status.bad"));
    assert.match(await page.locator("#status").textContent(), /WebGL/);
    await close();
});
