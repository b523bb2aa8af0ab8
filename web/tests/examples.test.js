// The programs of examples/javascript run in Node, in a project that has the package.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { cpSync, mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, symlinkSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import test, { after, before } from "node:test";
import { fileURLToPath } from "node:url";

const packageFolder = fileURLToPath(new URL("..", import.meta.url));
const root = fileURLToPath(new URL("../..", import.meta.url));
const project = mkdtempSync(join(tmpdir(), "kinopt-examples-"));
const programs = readdirSync(join(root, "examples/javascript")).filter((name) => name.endsWith(".js"));

before(() => {
    mkdirSync(join(project, "node_modules"));
    symlinkSync(packageFolder, join(project, "node_modules/kinopt"), "junction");
    symlinkSync(join(root, "models"), join(project, "models"), "junction");
    for (const name of [...programs, "package.json"]) cpSync(join(root, "examples/javascript", name), join(project, "examples/javascript", name));
});
after(() => rmSync(project, { recursive: true }));

for (const name of programs) {
    test(`${name} runs and fits on a page`, () => {
        assert.ok(readFileSync(join(root, "examples/javascript", name), "utf8").split("\n").length <= 41);
        const shown = execFileSync(process.execPath, ["--preserve-symlinks", join(project, "examples/javascript", name)], { cwd: project, encoding: "utf8" });
        assert.ok(shown.length > 0);
    });
}
