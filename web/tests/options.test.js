// The tables of docs/options.md name the options that there are, and no others.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import test from "node:test";

const text = (path) => readFileSync(new URL(path, import.meta.url), "utf8");

/** What a section's table has in its column of JavaScript: names of options, not of functions. */
function named(section) {
    const [, part] = text("../../docs/options.md").split(`\n## ${section}\n`);
    const rows = part.split("\n## ")[0].split("\n").filter((line) => line.startsWith("|")).map((line) => line.split("|").slice(1, -1));
    const column = rows[0].findIndex((cell) => cell.trim() === "JavaScript");
    const names = rows.slice(2).flatMap((row) => [...row[column].matchAll(/`([^`]+)`/g)].map(([, name]) => name));
    return names.filter((name) => !name.includes(".")).sort();
}

/** The keys of an interface of the package's types. */
function keys(name) {
    const [, body] = text("../dist/kinopt.d.ts").match(new RegExp(`export interface ${name} \\{([\\s\\S]*?)\\n\\}`));
    return [...body.matchAll(/^\s+(\w+)\?:/gm)].map(([, key]) => key).sort();
}

for (const [section, name, besides = []] of [["Arms", "ArmOptions"], ["Problems", "ProblemOptions", ["tasks"]], ["Tasks", "TaskOptions"], ["Solvers", "SolverOptions"]]) {
    test(`the table of ${section} is ${name}`, () => {
        assert.deepEqual(named(section), [...keys(name), ...besides].sort());
    });
}
