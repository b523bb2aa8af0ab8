// The built site on a static server, and a browser.
import { existsSync, readFileSync } from "node:fs";
import { createServer } from "node:http";
import { extname, join, normalize } from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";
import { chromium } from "playwright-core";

const dist = fileURLToPath(new URL("../dist/", import.meta.url));
const TYPES = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml", ".wasm": "application/wasm" };
const executablePath = [process.env.CHROMIUM, "/usr/bin/chromium", "/usr/bin/google-chrome"].find((path) => path && existsSync(path));

/** Reason why browser tests are skipped, or false. */
export const skip = executablePath ? false : "no Chromium is installed here";

/** Serves the site, or another folder, and starts a browser; `close` ends both. */
export async function started({ folder = dist, args: more = [] } = {}) {
    const server = createServer((request, response) => {
        const path = join(folder, normalize(new URL(request.url, "http://page").pathname).replace(/\/$/, "/index.html"));
        if (!path.startsWith(folder) || !existsSync(path)) return response.writeHead(404).end();
        const type = TYPES[extname(path)];
        response.setHeader("content-type", type ?? "application/octet-stream");
        // Texts are compressed, as by most hosts.
        if (!type?.startsWith("text/")) return response.end(readFileSync(path));
        response.setHeader("content-encoding", "gzip");
        return response.end(gzipSync(readFileSync(path)));
    });
    await new Promise((listening) => server.listen(0, "127.0.0.1", listening));
    // Software rendering, so that no graphics card is needed.
    const args = ["--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update",
        "--disable-sync", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", ...more];
    const browser = await chromium.launch({ executablePath, args });
    const close = async () => {
        await browser.close();
        server.close();
    };
    return { browser, address: `http://127.0.0.1:${server.address().port}/`, close };
}
