// The tables of docs/reference/options.md list exactly the existing options.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import test from "node:test";

const text = (path) => readFileSync(new URL(path, import.meta.url), "utf8");

/** Names in the JavaScript column of a section's table: options, without functions. */
function named(section) {
    const [, part] = text("../../docs/reference/options.md").split(`\n## ${section}\n`);
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

for (const [section, name, besides = []] of [["Arms", "ArmOptions"], ["Problems", "ProblemOptions", ["tasks"]], ["Tasks", "TaskOptions"], ["Solvers", "SolverOptions"], ["Followers and servos", "ServoOptions"]]) {
    test(`the table of ${section} is ${name}`, () => {
        assert.deepEqual(named(section), [...keys(name), ...besides].sort());
    });
}

test("the page on choosing names existing classes", () => {
    const types = text("../dist/kinopt.d.ts");
    const options = keys("ArmOptions");
    let count = 0;
    for (const [table] of text("../../docs/guide/choosing.md").matchAll(/(?:^\|.*\n)+/gm)) {
        const rows = table.trim().split("\n").map((line) => line.split("|").slice(1, -1));
        const column = rows[0].findIndex((cell) => cell.includes("JavaScript"));
        for (const [, name] of rows.slice(2).flatMap((row) => [...row[column].matchAll(/`([^`]+)`/g)])) {
            const [className, member] = name.split(/[.:]/);
            const body = types.match(new RegExp(`^export class ${className} \\{([\\s\\S]*?)^\\}`, "m"))?.[1];
            const exists = name.includes(".") ? new RegExp(`^    (static )?${member}\\(`, "m").test(body) : options.includes(className) || body || types.includes(`export function ${className}(`);
            assert.ok(exists, name);
            count += 1;
        }
    }
    assert.ok(count > 25, `${count} names`);
});
