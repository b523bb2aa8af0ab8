// What tests of the page share: it is opened in a browser, and what it says on the console is kept. KINOPT_PICTURES=FOLDER has them
// take the pictures of the README.
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
        /** A page that opened the humanoid, and all that it said on the console. */
        async opened(options) {
            // What software draws takes as long as it has points.
            const deviceScaleFactor = process.env.KINOPT_PICTURES ? 1 : 0.5;
            const page = await site.browser.newPage({ viewport: { width: 900, height: 640 }, deviceScaleFactor, colorScheme: "light", ...options });
            // As a machine with much other work needs: no test is about time.
            page.setDefaultTimeout(300_000);
            const said = [];
            // What software drawing says of itself is no word of the page, nor which version of Collada a file is of.
            page.on("console", (message) => /GPU stall|GL Driver|ColladaLoader: File version/.test(message.text()) || said.push(message.text()));
            page.on("pageerror", (error) => said.push(String(error)));
            await page.goto(site.address);
            await page.waitForFunction(() => globalThis.kinoptPage?.view);
            return { page, said };
        },
    };
}

/** Where a handle is seen, in pixels. */
export const seen = (page, name) =>
    page.evaluate((name) => {
        const { stage, view } = kinoptPage;
        return stage.toScreen(view.place(name));
    }, name);

export const status = (page) => page.locator("#status").textContent();

export const pictured = (page, name) =>
    process.env.KINOPT_PICTURES && page.screenshot({ path: join(process.env.KINOPT_PICTURES, name) });

/** All that was asked is answered and drawn. */
export const settled = (page) => page.waitForFunction(() => !kinoptPage.busy && !kinoptPage.moved && !kinoptPage.stage.asked);

/** A file of text, as it is chosen. */
export const file = (name, text) => ({ name, mimeType: "text/plain", buffer: Buffer.from(text) });

/** The colour of a handle, as on the page. */
export const colour = (page, name) =>
    page.evaluate((name) => {
        const { view, opened } = kinoptPage;
        const color = view.balls.material.color.clone();
        view.balls.getColorAt(opened.handles.indexOf(name), color);
        return color.getHex();
    }, name);
