// Common code of tests of the page: it is opened in a browser, and its console messages are recorded.
// KINOPT_PICTURES=FOLDER writes the pictures of the README and of web/site/images.
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { skip, started } from "./browser.js";

export const models = fileURLToPath(new URL("../../../models/", import.meta.url));

/** A browser for the tests of one file, from `begin` to `end`. */
export function visiting() {
    let site;
    return {
        begin: async () => {
            if (!skip) site = await started();
        },
        end: () => site?.close(),
        /** A page with the humanoid, and all its console messages. */
        async opened(options) {
            // The time of software rendering depends on the number of pixels.
            const deviceScaleFactor = process.env.KINOPT_PICTURES ? 1 : 0.5;
            const page = await site.browser.newPage({ viewport: { width: 900, height: 640 }, deviceScaleFactor, colorScheme: "light", reducedMotion: "reduce", ...options });
            // Long, for machines with other load: no test measures time.
            page.setDefaultTimeout(300_000);
            const consoleMessages = [];
            // Messages of software rendering and about Collada versions are not the page's.
            page.on("console", (message) => /GPU stall|GL Driver|ColladaLoader: File version/.test(message.text()) || consoleMessages.push(message.text()));
            page.on("pageerror", (error) => consoleMessages.push(String(error)));
            await page.goto(site.address);
            await page.waitForFunction(() => globalThis.kinoptPage?.view);
            return { page, consoleMessages };
        },
    };
}

/** Position of a handle on the page, in pixels. */
export const seen = (page, name) =>
    page.evaluate((name) => {
        const { pointer, view } = kinoptPage;
        return pointer.toScreen(view.place(name));
    }, name);

export const status = (page) => page.locator("#status").textContent();

export const pictured = (page, name) =>
    process.env.KINOPT_PICTURES && page.screenshot({ path: join(process.env.KINOPT_PICTURES, name) });

/** Writes the drawing without the lines of the ground as a picture for the time before the page is loaded. */
export async function postered(page, name) {
    if (!process.env.KINOPT_PICTURES) return;
    const data = await page.evaluate(() => {
        const { stage, view } = kinoptPage;
        const [, lines] = view.grid.children;
        lines.visible = false;
        stage.renderer.render(stage.scene, stage.camera);
        lines.visible = true;
        return stage.canvas.toDataURL("image/webp", 0.55);
    });
    writeFileSync(join(process.env.KINOPT_PICTURES, name), Buffer.from(data.split(",")[1], "base64"));
}

/** Waits until all requests are done and drawn. */
export const settled = (page) => page.waitForFunction(() => !kinoptPage.busy && !kinoptPage.moved && !kinoptPage.stage.renderRequest);

/** A text file as it is chosen. */
export const file = (name, text) => ({ name, mimeType: "text/plain", buffer: Buffer.from(text) });

/** Colour of a handle on the page. */
export const colour = (page, name) =>
    page.evaluate((name) => {
        const { view, opened } = kinoptPage;
        const color = view.balls.material.color.clone();
        view.balls.getColorAt(opened.handles.indexOf(name), color);
        return color.getHex();
    }, name);
