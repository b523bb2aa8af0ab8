// The model and its pose are kept after an invalid file. Other pointers do not end a drag. The page works without a
// mouse.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import test, { after, before } from "node:test";
import { skip } from "./browser.js";
import { file, models, seen, settled, status, visiting } from "./visit.js";

const { opened, begin, end } = visiting();
before(begin);
after(end);

const at = (page, name) => page.evaluate((name) => kinoptPage.view.place(name).toArray(), name);
const bad = file("odd.urdf", "<robot");

test("an invalid file keeps pose, grabbed handle and playback", { skip }, async () => {
    const { page, consoleMessages } = await opened();
    const hand = await seen(page, "left_hand");
    const rest = await at(page, "left_hand");
    await page.mouse.move(hand.x, hand.y);
    await page.mouse.down();
    await page.mouse.move(hand.x - 30, hand.y + 60, { steps: 20 });
    await page.mouse.up();
    await settled(page);
    const pulled = await at(page, "left_hand");
    assert.ok(Math.hypot(...pulled.map((value, k) => value - rest[k])) > 0.05);
    await page.locator("#file").setInputFiles([bad]);
    await page.waitForFunction(() => document.querySelector("#status.bad"));
    assert.deepEqual(await at(page, "left_hand"), pulled);
    assert.equal(await page.evaluate(() => kinoptPage.grabbed), "left_hand");
    await page.mouse.move(10, 300);
    await page.locator("#play").click();
    await page.locator("#file").setInputFiles([bad]);
    await page.waitForFunction(() => !kinoptPage.opening);
    assert.ok(await page.evaluate(() => kinoptPage.playback.running));
    await page.locator("#file").setInputFiles([file("rig.json", "{}")]);
    await page.waitForFunction(() => /rig\.json/.test(document.querySelector("#status").textContent));
    assert.deepEqual(consoleMessages, []);
    await page.close();
});

test("a file's error stays until a handle is grabbed", { skip }, async () => {
    const { page } = await opened();
    const hand = await seen(page, "left_hand");
    await page.mouse.move(hand.x, hand.y);
    await page.mouse.down();
    await page.mouse.move(hand.x, hand.y - 500, { steps: 20 });
    await page.waitForFunction(() => /left_hand misses/.test(document.querySelector("#status").textContent));
    assert.doesNotMatch(await status(page), /\/tip|twist|bend/, "bones are reported by their names");
    await page.locator("#file").setInputFiles([bad]);
    await page.waitForFunction(() => document.querySelector("#status.bad"));
    // Many pictures later, with the body solved again or at rest.
    await page.waitForTimeout(1000);
    assert.match(await status(page), /odd\.urdf/);
    await page.mouse.up();
    // The body goes on until it rests.
    await settled(page);
    // The left hand is below the header.
    const handle = await seen(page, "right_hand");
    await page.mouse.move(handle.x, handle.y);
    await page.mouse.down();
    await page.mouse.up();
    await settled(page);
    assert.doesNotMatch(await status(page), /odd\.urdf/);
    await page.close();
});

test("a rig without its files asks for them", { skip }, async () => {
    const { page } = await opened();
    const humanoid = readFileSync(join(models, "humanoid/humanoid.json"), "utf8");
    await page.locator("#file").setInputFiles([file("humanoid.json", humanoid)]);
    await page.waitForFunction(() => document.querySelector("#status.bad"));
    assert.match(await status(page), /humanoid\.ply.*Drop this file too/);
    await page.close();
});

test("a robot without shapes has sticks", { skip }, async () => {
    const { page } = await opened();
    const joint = (parent, child) => `<joint name="${child}_joint" type="revolute"><parent link="${parent}"/><child link="${child}"/><origin xyz="0.5 0 0"/>
        <axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>`;
    await page.locator("#file").setInputFiles([file("bare.urdf", `<robot name="bare"><link name="a"/><link name="b"/><link name="c"/>${joint("a", "b")}${joint("b", "c")}</robot>`)]);
    await page.waitForFunction(() => kinoptPage.opened.kind === "robot");
    assert.equal(await page.evaluate(() => kinoptPage.view.limbs.pairs.length), 2);
    assert.match(await status(page), /no shapes/);
    assert.equal(await page.locator("#choose").textContent(), "Your file: bare.urdf");
    assert.equal(await page.locator('[data-open][aria-pressed="true"]').count(), 0);
    await page.close();
});

test("gaps between plain shapes are filled by sticks", { skip }, async () => {
    const { page } = await opened();
    const link = (name, radius) => `<link name="${name}">${radius ? `<visual><geometry><sphere radius="${radius}"/></geometry></visual>` : ""}</link>`;
    const joint = (parent, child) => `<joint name="${child}_joint" type="continuous"><parent link="${parent}"/><child link="${child}"/><origin xyz="0.5 0 0"/></joint>`;
    for (const [radius, pairs] of [[0.3, [[0, 1], [1, 2]]], [0.6, undefined]]) {
        const links = link("a", radius) + link("b") + link("c", radius);
        const name = `spheres_${radius}.urdf`;
        await page.locator("#file").setInputFiles([file(name, `<robot name="spheres">${links}${joint("a", "b")}${joint("b", "c")}</robot>`)]);
        await page.waitForFunction((name) => document.querySelector("#choose").textContent.includes(name), name);
        assert.deepEqual(await page.evaluate(() => kinoptPage.view.limbs?.pairs), pairs, name);
        assert.equal(await status(page), "");
    }
    await page.close();
});

test("keys select a file and joints, and move the view", { skip }, async () => {
    const { page, consoleMessages } = await opened();
    // The file chooser belongs to the browser.
    await page.evaluate(() => {
        window.asked = 0;
        document.querySelector("#file").addEventListener("click", (event) => { event.preventDefault(); window.asked += 1; });
    });
    for (const key of ["Enter", " "]) {
        await page.locator("#choose").focus();
        await page.keyboard.press(key);
    }
    assert.equal(await page.evaluate(() => window.asked), 2);
    assert.ok(await page.locator("#file").evaluate((input) => input.multiple));
    await page.locator("#stage").focus();
    const camera = () => page.evaluate(() => kinoptPage.stage.camera.position.toArray());
    const from = await camera();
    await page.keyboard.press("ArrowRight");
    const turned = await camera();
    assert.ok(Math.hypot(...turned.map((value, k) => value - from[k])) > 0.05, "an arrow key rotates the view");
    await page.keyboard.press("+");
    const away = (position) => page.evaluate((position) => kinoptPage.stage.orbit.target.distanceTo({ x: position[0], y: position[1], z: position[2] }), position);
    assert.ok((await away(await camera())) < 0.95 * (await away(turned)), "plus zooms in");
    await page.keyboard.press("j");
    const first = await page.evaluate(() => kinoptPage.grabbed);
    await page.keyboard.press("j");
    assert.notEqual(await page.evaluate(() => kinoptPage.grabbed), first);
    await page.keyboard.press("Shift+J");
    assert.equal(await page.evaluate(() => kinoptPage.grabbed), first);
    await page.keyboard.press("Shift+S");
    assert.equal(await page.evaluate(() => kinoptPage.method), "dqs");
    await page.keyboard.press("Tab");
    assert.equal(await page.evaluate(() => document.activeElement.id), "pin");
    assert.deepEqual(consoleMessages, []);
    await page.close();
});

test("a hovered joint is marked; its own pointer releases it", { skip }, async () => {
    const { page } = await opened();
    const cursor = () => page.evaluate(() => getComputedStyle(kinoptPage.stage.canvas).cursor);
    const hand = await seen(page, "left_hand");
    await page.mouse.move(hand.x, hand.y);
    assert.equal(await cursor(), "grab");
    await page.mouse.down();
    assert.equal(await cursor(), "grabbing");
    const other = (type) => page.evaluate((type) => kinoptPage.stage.canvas.dispatchEvent(new PointerEvent(type, { pointerId: 77, pointerType: "touch", clientX: 5, clientY: 300, bubbles: true })), type);
    await other("pointerdown");
    assert.equal(await page.evaluate(() => kinoptPage.stage.orbit.enabled), false, "a second finger does not rotate the view");
    await other("pointerup");
    assert.ok(await page.evaluate(() => kinoptPage.held));
    await page.mouse.up();
    assert.ok(await page.evaluate(() => !kinoptPage.held));
    await page.close();
});

test("reduced motion starts no playback", { skip }, async () => {
    const { page } = await opened({ reducedMotion: "reduce" });
    await page.locator('[data-open="capture"]').click();
    await page.waitForFunction(() => kinoptPage.opened.kind === "movement", undefined, { timeout: 60_000 });
    assert.equal(await page.evaluate(() => kinoptPage.playback.running), false);
    await page.close();
});

test("a failed fetch is reported", { skip }, async () => {
    const { page } = await opened();
    await page.route("**/franka_panda.urdf.packed", (route) => route.abort());
    await page.locator('[data-open="panda"]').click();
    await page.waitForFunction(() => document.querySelector("#status.bad"));
    assert.match(await status(page), /franka_panda\.urdf cannot be fetched/);
    await page.close();
});
