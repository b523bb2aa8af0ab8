// The references contain all exports of the packages, each with its text.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import test from "node:test";
import { source } from "../docs/contents.js";
import { javascriptReference } from "../docs/javascript_reference.js";
import { pythonReference } from "../docs/python_reference.js";

/** The parts of a page below its headings, by name. */
function parts(page, sign) {
    const found = page.split(new RegExp(`^${sign} `, "m")).slice(1);
    return new Map(found.map((part) => [part.split("\n", 1)[0], part.slice(part.indexOf("\n"))]));
}

/** The text of a part without signatures. */
const words = (part) => part.replace(/```[\s\S]*?```/g, "").split("\n").filter((line) => line && !line.startsWith("- `") && !line.startsWith("  "));

test("the Python reference has a text for every export", () => {
    const all = parts(pythonReference(), "###");
    const exported = [...source("python/kinopt/__init__.py").split("__all__ = [")[1].matchAll(/"(\w+)"/g)].map(([, name]) => name);
    const modules = ["animation", "io", "methods", "models", "retargeting", "skinning", "tasks"];
    const documented = new Set([...all.keys()].map((name) => name.split(".").at(-1)));
    assert.deepEqual(exported.filter((name) => !documented.has(name) && !modules.includes(name) && name !== "__version__"), []);
    assert.deepEqual([...all].filter(([, part]) => words(part).length === 0).map(([name]) => name), []);
    assert.ok(all.size > 150, `${all.size}`);
});

test("the JavaScript reference has a text for every class", () => {
    const all = parts(javascriptReference(), "##");
    const [, line] = readFileSync(new URL("../../dist/index.d.ts", import.meta.url), "utf8").match(/^export \{ (.*?) \}/m);
    const functions = all.get("Functions");
    assert.deepEqual(line.split(", ").filter((name) => !all.has(name) && !functions.includes(`\`${name}(`)), []);
    const classes = line.split(", ").filter((name) => all.has(name));
    assert.deepEqual(classes.filter((name) => words(all.get(name)).length === 0), []);
    assert.ok(classes.length > 20, `${classes.length}`);
});
