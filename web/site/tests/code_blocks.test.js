// Every block of code on the site's pages is run by some test.
import assert from "node:assert/strict";
import test from "node:test";
import { contents, pages, REFERENCES, source } from "../docs/contents.js";

const library = source("src/lib.rs");
/** Who runs a language's blocks, and on which pages. */
const RUNNERS = {
    // Tests of the documentation, of the pages that the library names.
    rust: (path) => library.includes(`include_str!("../${path}")`),
    // python/tests/test_readme.py: all of docs/ and the package's page; test_ray.py what is with Ray.
    python: (path) => path.startsWith("docs/") || path === "README.md" || path === "python/README.md",
    // web/tests/pages.test.js: all of docs/; web/tests/package.test.js: the package's page.
    js: (path) => path.startsWith("docs/") || path === "web/README.md",
    // package.test.js beside this.
    html: (path) => path === "web/README.md",
    // cli/tests/command/pages.rs.
    sh: (path) => path.startsWith("docs/") || path === "README.md",
};
/** Who runs what is said to be run in another way, by what its fence says of it. */
const WAYS = {
    // python/tests/test_readme.py; package.test.js beside this.
    "until its page answers": (path) => RUNNERS.python(path) || path === "README.md",
    // python/tests/test_ray.py.
    "with Ray": (path) => path === "python/README.md",
    // web/tests/package.test.js.
    "in an empty project": (path) => path === "web/README.md",
};

/** Which commands of a block a script of the gate does not have. */
function missing(script, text) {
    // A step says what it runs, more quietly.
    const steps = source(script).replaceAll(/\bstep /g, "").replaceAll(/ --quiet\b/g, "");
    const commands = text.split(/\n|&&/).map((command) => command.replace(/ +#.*/, "").trim());
    return commands.filter((command) => command && !command.startsWith("cd ") && !steps.includes(command));
}
// Nothing to run.
const DATA = new Set(["json", "yaml", "xml", "toml", "text"]);

export function blocks(text) {
    const found = [];
    let open;
    for (const [number, line] of text.split("\n").entries()) {
        const fence = line.match(/^\s*```(.*)/);
        if (!fence) open?.push(line);
        else if (open) open = undefined;
        else found.push({ info: fence[1].trim(), line: number + 1, lines: (open = []) });
    }
    return found;
}

test("every block of code has a runner", () => {
    const unrun = [];
    let run = 0;
    for (const { path } of pages(contents()).values()) {
        if (REFERENCES[path]) continue;
        for (const { info, line, lines } of blocks(source(path))) {
            const [, language, way] = info.match(/^(\w*)[\s,]*(.*)/);
            if (DATA.has(language)) continue;
            const script = way.match(/^run by (\S+)$/)?.[1];
            const left = script ? missing(script, lines.join("\n")) : [];
            const runner = script ? () => true : (WAYS[way] ?? RUNNERS[language]);
            if (runner?.(path) && left.length === 0) run += 1;
            else unrun.push(`${path}:${line} ${info || "(no language)"} ${left}`);
        }
    }
    assert.deepEqual(unrun, []);
    assert.ok(run > 60, `${run} blocks`);
});
