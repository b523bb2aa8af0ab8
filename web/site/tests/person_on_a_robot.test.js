// A robot follows a captured subject: online, with another dropped capture, and solved as a whole.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { join } from "node:path";
import test, { after, before } from "node:test";
import { skip } from "./browser.js";
import { file, models, pictured, settled, status, visiting } from "./visit.js";

const { opened, begin, end } = visiting();
before(begin);
after(end);

test("a robot follows a subject live and as a whole", { skip }, async () => {
    const { page, consoleMessages } = await opened({ reducedMotion: "no-preference" });
    await page.locator('[data-open="capture"]').click();
    await page.waitForFunction(() => kinoptPage.opened?.kind === "movement" && kinoptPage.frames.length > 20, undefined, { timeout: 60_000 });
    const state = () => page.evaluate(() => ({
        robot: kinoptPage.view.links.map(({ matrix }) => matrix.elements.slice(12, 15)).flat(),
        person: kinoptPage.view.person && [...kinoptPage.view.person],
    }));
    const before = await state();
    const drawn = await page.evaluate(() => kinoptPage.frames.length);
    assert.ok(before.robot.every(Number.isFinite) && before.person.every(Number.isFinite));
    await page.waitForFunction((drawn) => kinoptPage.frames.length > drawn + 30, drawn);
    if (process.env.KINOPT_PICTURES) await page.waitForFunction(() => Math.abs(kinoptPage.playback.seconds - 5.3) < 0.2);
    await pictured(page, "web-capture.png");
    const later = await state();
    const moved = (a, b) => Math.max(...a.map((value, k) => Math.abs(value - b[k])));
    assert.ok(moved(before.robot, later.robot) > 0.005 && moved(before.person, later.person) > 0.005);
    await page.locator("#play").click();
    await page.waitForFunction(() => !kinoptPage.playback.running);
    await settled(page);
    const still = await state();
    await page.waitForTimeout(300);
    assert.deepEqual(await state(), still);
    await page.locator("#play").click();
    const steps = await page.evaluate(() => kinoptPage.frames.filter(({ steps }) => steps > 0).map(({ solved, steps }) => solved / steps).sort((a, b) => a - b));
    console.log(`${steps.length} answers: ${steps[steps.length >> 1].toFixed(2)} ms a captured frame in the median`);

    await page.locator("#whole").click();
    await page.waitForFunction(() => kinoptPage.whole !== undefined, undefined, { timeout: 120_000 });
    assert.match(await status(page), /mean direction error \d+\.\d°/);
    const { slip } = await page.evaluate(() => kinoptPage.whole);
    assert.ok(slip < 0.01);
    await page.locator("#whole").click();
    await page.waitForFunction(() => kinoptPage.whole === undefined);

    // A dropped capture, which takes long to solve as a whole: progress is shown, playback continues, and it is
    // stopped.
    const capture = await readFile(join(models, "captures/steps.bvh"), "utf8");
    const [head, motion] = capture.split(/Frame Time: .*\n/);
    const long = `${head.replace(/Frames: \d+/, `Frames: ${181 * 200}`)}Frame Time: 0.0333333\n${motion.repeat(200)}`;
    await page.locator("#file").setInputFiles([file("mine.bvh", long)]);
    await page.waitForFunction(() => kinoptPage.opened.seconds > 300, undefined, { timeout: 60_000 });
    assert.equal(await page.evaluate(() => kinoptPage.opened.kind), "movement", "it is on the previous robot");
    await page.locator("#whole").click();
    await page.waitForFunction(() => /\d+ of 36200 frames/.test(document.querySelector("#status").textContent), undefined, { timeout: 120_000 });
    const [from, count] = [await state(), await page.evaluate(() => kinoptPage.frames.length)];
    await page.waitForFunction((count) => kinoptPage.frames.length > count + 5, count);
    assert.ok(moved(from.robot, (await state()).robot) > 0.001, "online retargeting continues");
    await page.locator("#stop").click();
    await page.waitForFunction(() => document.querySelector("#status").textContent === "Stopped.");
    assert.ok(await page.locator("#stop").isHidden());
    assert.equal(await page.evaluate(() => kinoptPage.opened.kind), "movement");

    // A capture without a body is an error, and the previous motion continues.
    await page.locator("#file").setInputFiles([file("rope.bvh", "HIERARCHY\nROOT a {\nOFFSET 0 0 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nEnd Site {\nOFFSET 0 1 0\n}\n}\nMOTION\nFrames: 1\nFrame Time: 0.1\n0 0 0\n")]);
    await page.waitForFunction(() => document.querySelector("#status.bad"));
    const statusText = await status(page);
    assert.match(statusText, /body/);
    const shown = await page.evaluate(() => kinoptPage.frames.length);
    await page.waitForFunction((shown) => kinoptPage.frames.length > shown + 5, shown);
    assert.equal(await status(page), statusText, "the error stays");
    assert.deepEqual(consoleMessages, []);
    await page.close();
});
