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
    // What software drawing says of itself is no word of the page.
    page.on("console", (message) => /GPU stall|GL Driver/.test(message.text()) || said.push(message.text()));
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
