// A robot is dragged like a figure: it is on its feet, pinned frames stay, and joints at limits are marked.
import assert from "node:assert/strict";
import { join } from "node:path";
import test, { after, before } from "node:test";
import { skip } from "./browser.js";
import { colour, file, models, pictured, seen, settled, status, visiting } from "./visit.js";

const { opened, begin, end } = visiting();
before(begin);
after(end);

/** The page with a robot of these files. */
async function robot(files, options) {
    const { page, consoleMessages } = await opened(options);
    await page.locator("#file").setInputFiles(files);
    await page.waitForFunction(() => kinoptPage.opened.kind === "robot", undefined, { timeout: 60_000 });
    // The view changes until the robot is drawn.
    await settled(page);
    return { page, consoleMessages };
}

async function pull(page, name, right, down) {
    const at = await seen(page, name);
    await page.mouse.move(at.x, at.y);
    await page.mouse.down();
    assert.equal(await page.evaluate(() => kinoptPage.grabbed), name);
    for (let k = 1; k <= 30; k += 1) {
        await page.mouse.move(at.x + (right * k) / 30, at.y + (down * k) / 30);
        await page.waitForTimeout(1000 / 60);
    }
    await page.mouse.up();
    await settled(page);
}

/** Placement of a link: sixteen numbers. */
const placed = (page, name) =>
    page.evaluate((name) => {
        const { view } = kinoptPage;
        return view.links[kinoptPage.opened.names.indexOf(name)].matrix.elements.slice();
    }, name);
const away = (a, b) => Math.max(...a.map((value, k) => Math.abs(value - b[k])));
const [RED, BLUE] = [0xc8442f, 0x1f6fb2];

test("a legged robot keeps its feet during short drags", { skip }, async () => {
    const { page, consoleMessages } = await robot(join(models, "aldebaran_nao.urdf"));
    const feet = ["left_sole", "right_sole"];
    assert.deepEqual(await page.evaluate(() => [...kinoptPage.pins]), feet);
    assert.equal(await colour(page, "left_sole"), BLUE);
    const stood = await Promise.all(feet.map((foot) => placed(page, foot)));
    for (const [name, right, down] of [["head", 20, 10], ["right_elbow", -20, 10], ["left_hand", 10, 60]]) {
        const begun = await page.evaluate((name) => kinoptPage.view.place(name).toArray(), name);
        await pull(page, name, right, down);
        const ended = await page.evaluate((name) => kinoptPage.view.place(name).toArray(), name);
        assert.ok(away(begun, ended) > 0.01, `${name} is pulled`);
        for (const [k, foot] of feet.entries()) assert.ok(away(await placed(page, foot), stood[k]) < 1e-3, `${foot} stays while ${name} is pulled`);
    }
    await pictured(page, "web-robot.png");
    await pull(page, "left_hand", 0, -400);
    assert.match(await status(page), /left_hand misses|[Oo]ut of reach/);
    const red = await page.evaluate(() => kinoptPage.limits);
    assert.ok(red.length > 0, "some joint is at its limit");
    const grabbed = await page.evaluate(() => kinoptPage.grabbed);
    for (const name of red.filter((name) => name !== grabbed)) assert.equal(await colour(page, name), RED, name);
    await pull(page, "left_sole", 200, -300);
    assert.match(await status(page), /Pinned joints or the balance prevent it/);
    assert.doesNotMatch(await status(page), /[Ll]evels?\b/);
    assert.deepEqual(consoleMessages, []);
    await page.close();
});

test("any frame of a robot is pinned and unpinned", { skip }, async () => {
    const { page, consoleMessages } = await robot(join(models, "aldebaran_nao.urdf"));
    const hand = await seen(page, "right_hand");
    await page.mouse.click(hand.x, hand.y);
    await page.locator("#pin").click();
    assert.equal(await page.locator("#pin").textContent(), "Unpin");
    const before = await placed(page, "right_hand");
    await pull(page, "left_hand", 10, 60);
    assert.ok(away(await placed(page, "right_hand"), before) < 1e-3, "a pinned hand stays");
    await page.mouse.click(hand.x, hand.y);
    await page.locator("#pin").click();
    await pull(page, "right_hand", 10, 40);
    assert.ok(away(await placed(page, "right_hand"), before) > 0.01, "an unpinned hand moves along");
    // A dragged foot keeps its sole level, and the other foot stays.
    const [left, right] = await Promise.all(["left_sole", "right_sole"].map((foot) => placed(page, foot)));
    await pull(page, "left_sole", 0, -30);
    const [lifted, stood] = await Promise.all(["left_sole", "right_sole"].map((foot) => placed(page, foot)));
    assert.ok(lifted[14] > left[14] + 0.02 && away(lifted.slice(0, 12), left.slice(0, 12)) < 0.05);
    assert.ok(away(stood, right) < 1e-3);
    assert.deepEqual(consoleMessages, []);
    await page.close();
});

test("an elbow is dragged while the pinned tool stays", { skip }, async () => {
    const { page, consoleMessages } = await opened();
    await page.locator('[data-open="panda"]').click();
    await page.waitForFunction(() => kinoptPage.opened?.kind === "robot", undefined, { timeout: 60_000 });
    const tool = await seen(page, "flange");
    await page.mouse.click(tool.x, tool.y);
    await page.keyboard.press("p");
    const before = await placed(page, "flange");
    const elbow = await page.evaluate(() => kinoptPage.view.place("link4").toArray());
    await pull(page, "link4", -60, 30);
    assert.ok(away(await page.evaluate(() => kinoptPage.view.place("link4").toArray()), elbow) > 0.02, "the elbow swings");
    assert.ok(away(await placed(page, "flange"), before) < 1e-3, "the tool stays");
    assert.deepEqual(consoleMessages, []);
    await page.close();
});

test("a joint at an active limit is red", { skip }, async () => {
    const link = (name) => `<link name="${name}"><visual><origin xyz="0.25 0 0"/><geometry><box size="0.5 0.05 0.05"/></geometry></visual></link>`;
    const joint = (parent, child, x) => `<joint name="${child}_joint" type="revolute"><parent link="${parent}"/><child link="${child}"/><origin xyz="${x} 0 0"/>
        <axis xyz="0 1 0"/><limit lower="-0.4" upper="0.4" effort="1" velocity="1"/></joint>`;
    const fixed = `<joint name="end" type="fixed"><parent link="c"/><child link="tip"/><origin xyz="0.5 0 0"/></joint>`;
    const urdf = `<robot name="two">${link("a")}${link("b")}${link("c")}<link name="tip"/>${joint("a", "b", 0.5)}${joint("b", "c", 0.5)}${fixed}</robot>`;
    const { page, consoleMessages } = await robot(file("two.urdf", urdf));
    assert.deepEqual(await page.evaluate(() => kinoptPage.opened.handles), ["tip", "b"]);
    await pull(page, "tip", -150, -250);
    assert.ok((await page.evaluate(() => kinoptPage.limits)).includes("b"));
    assert.equal(await colour(page, "b"), RED);
    assert.match(await status(page), /limit/);
    assert.deepEqual(consoleMessages, []);
    await page.close();
});
