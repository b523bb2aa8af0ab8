// JavaScript blocks of the pages of docs/, docs/guide and docs/reference run in Node, each alone, in the project's root.
import { execFileSync } from "node:child_process";
import { mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, symlinkSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import test, { after, before } from "node:test";
import { fileURLToPath } from "node:url";

const packageFolder = fileURLToPath(new URL("..", import.meta.url));
const root = fileURLToPath(new URL("../..", import.meta.url));
const project = mkdtempSync(join(tmpdir(), "kinopt-pages-"));

before(() => {
    mkdirSync(join(project, "node_modules"));
    symlinkSync(packageFolder, join(project, "node_modules/kinopt"), "junction");
});
after(() => rmSync(project, { recursive: true }));

const folders = ["docs", "docs/guide", "docs/reference"];
const pages = folders.flatMap((folder) => readdirSync(join(root, folder)).filter((name) => name.endsWith(".md")).map((name) => `${folder}/${name}`));
for (const page of pages) {
    const blocks = [...readFileSync(join(root, page), "utf8").matchAll(/^```js\n(.*?)^```/gms)].map(([, text]) => text);
    for (const [number, text] of blocks.entries()) {
        test(`${page}, block ${number + 1}`, () => {
            const file = join(project, `${page.replaceAll("/", "-")}-${number}.mjs`);
            writeFileSync(file, text);
            execFileSync(process.execPath, ["--preserve-symlinks", file], { cwd: root, encoding: "utf8", stdio: "pipe" });
        });
    }
}
