// Every code block on the site's pages is run by a test.
import assert from "node:assert/strict";
import test from "node:test";
import { contents, pages, REFERENCES, source } from "../docs/contents.js";

const library = source("src/lib.rs");
/** Test that runs the blocks of a language, by page. */
const RUNNERS = {
    // Doc tests of the pages that the library includes.
    rust: (path) => library.includes(`include_str!("../${path}")`),
    // python/tests/test_readme.py: all of docs/ and the package's page; blocks with other packages: below.
    python: (path) => path.startsWith("docs/") || path === "README.md" || path === "python/README.md",
    // web/tests/pages.test.js: all of docs/; web/tests/package.test.js: the package's page.
    js: (path) => path.startsWith("docs/") || path === "web/README.md",
    // package.test.js in this folder.
    html: (path) => path === "web/README.md",
    // crates/kinopt-c/tests/CMakeLists.txt.
    c: (path) => path === "docs/guide/cpp.md",
    cpp: (path) => path === "docs/guide/cpp.md",
    // cli/tests/command/pages.rs.
    sh: (path) => path.startsWith("docs/") || path === "README.md",
};
/** Test that runs a block after an HTML comment, by the text of the comment. */
const MARKED = {
    // python/tests/test_readme.py; package.test.js in this folder.
    "until its page answers": (path) => RUNNERS.python(path) || path === "README.md",
    // python/tests/test_ray.py.
    "with Ray": (path) => path === "python/README.md",
    // python/tests/test_robot_sources.py and test_rerun.py.
    "with robot_descriptions": (path) => path === "docs/guide/interoperation.md",
    "with xacrodoc": (path) => path === "docs/guide/interoperation.md",
    "with Rerun": (path) => path === "docs/guide/interoperation.md",
    // web/tests/package.test.js.
    "in an empty project": (path) => path === "web/README.md",
};

/** Commands of a block that a script of the gate lacks. */
function missing(script, text) {
    // The scripts prefix commands with `step`, and add quiet flags.
    const steps = source(script).replaceAll(/\bstep /g, "").replaceAll(/ --quiet\b/g, "");
    const commands = text.split(/\n|&&/).map((command) => command.replace(/ +#.*/, "").trim());
    return commands.filter((command) => command && !command.startsWith("cd ") && !steps.includes(command));
}
// Blocks without commands.
const DATA = new Set(["json", "yaml", "xml", "toml", "text"]);

export function blocks(text) {
    const found = [];
    let open;
    let marker = "";
    for (const [number, line] of text.split("\n").entries()) {
        const fence = line.match(/^\s*```(.*)/);
        if (!fence) open?.push(line);
        else if (open) open = undefined;
        else found.push({ info: fence[1].trim(), marker, line: number + 1, lines: (open = []) });
        marker = line.match(/^<!-- (.*) -->$/)?.[1] ?? "";
    }
    return found;
}

test("every code block is run by a test", () => {
    const unrun = [];
    let run = 0;
    for (const { path } of pages(contents()).values()) {
        if (REFERENCES[path]) continue;
        for (const { info, marker, line, lines } of blocks(source(path))) {
            const [language] = info.match(/^\w*/);
            if (DATA.has(language)) continue;
            const script = marker.match(/^run by (\S+)$/)?.[1];
            const left = script ? missing(script, lines.join("\n")) : [];
            const runner = script ? () => true : (MARKED[marker] ?? RUNNERS[language]);
            if (runner?.(path) && left.length === 0) run += 1;
            else unrun.push(`${path}:${line} ${info || "(no language)"} ${left}`);
        }
    }
    assert.deepEqual(unrun, []);
    assert.ok(run > 60, `${run} blocks`);
});
