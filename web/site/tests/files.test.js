// Files are chosen, and the page shows the library's error for invalid ones.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { join } from "node:path";
import test, { after, before } from "node:test";
import { skip } from "./browser.js";
import { file, models, seen, settled, status, visiting } from "./visit.js";

const { opened, begin, end } = visiting();
before(begin);
after(end);

test("invalid files show the library's error", { skip }, async () => {
    const { page, consoleMessages } = await opened();
    const choose = async (...files) => page.locator("#file").setInputFiles(files);
    const panda = await readFile(join(models, "franka_panda.urdf"), "utf8");
    await choose(file("odd.urdf", panda.replace('type="revolute"', 'type="rotating"')));
    await page.waitForFunction(() => document.querySelector("#status.bad"));
    assert.match(await status(page), /odd\.urdf.*rotating/s);
    assert.equal(await page.evaluate(() => kinoptPage.opened.kind), "character", "the model stays");
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
    assert.deepEqual(consoleMessages, []);
    await page.close();
});
