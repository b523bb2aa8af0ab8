// The blocks of JavaScript on the pages of docs/ run in Node, each by itself, with the project's root as the folder that files are
// looked for in.
import { execFileSync } from "node:child_process";
import { mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, symlinkSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import test, { after, before } from "node:test";
import { fileURLToPath } from "node:url";

const own = fileURLToPath(new URL("..", import.meta.url));
const root = fileURLToPath(new URL("../..", import.meta.url));
const project = mkdtempSync(join(tmpdir(), "kinopt-pages-"));

before(() => {
    mkdirSync(join(project, "node_modules"));
    symlinkSync(own, join(project, "node_modules/kinopt"), "junction");
});
after(() => rmSync(project, { recursive: true }));

for (const page of readdirSync(join(root, "docs")).filter((name) => name.endsWith(".md"))) {
    const blocks = [...readFileSync(join(root, "docs", page), "utf8").matchAll(/^```js\n(.*?)^```/gms)].map(([, text]) => text);
    for (const [number, text] of blocks.entries()) {
        test(`docs/${page}, block ${number + 1}`, () => {
            const file = join(project, `${page}-${number}.mjs`);
            writeFileSync(file, text);
            execFileSync(process.execPath, ["--preserve-symlinks", file], { cwd: root, encoding: "utf8", stdio: "pipe" });
        });
    }
}
