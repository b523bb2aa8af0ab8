// Every block of code on the site's pages is run by some test, or says on the page that it is not.
import assert from "node:assert/strict";
import test from "node:test";
import { contents, pages, REFERENCES, source } from "../docs/contents.js";

const library = source("src/lib.rs");
/** Who runs a language's blocks, and on which pages. */
const RUNNERS = {
    // Tests of the documentation, of the pages that the library names.
    rust: (path) => library.includes(`include_str!("../${path}")`),
    // python/tests/test_readme.py: all of docs/ and the package's page; test_ray.py what is with Ray.
    python: (path) => path.startsWith("docs/") || path === "python/README.md",
    // web/tests/pages.test.js: all of docs/; web/tests/package.test.js: the package's page.
    js: (path) => path.startsWith("docs/") || path === "web/README.md",
    // package.test.js beside this.
    html: (path) => path === "web/README.md",
    // cli/tests/command/pages.rs.
    sh: (path) => path.startsWith("docs/") || path === "README.md",
};
// python/tests/test_readme.py: what opens a page in the browser.
const opensPage = (path, info) => info.endsWith("until its page answers") && RUNNERS.python(path);
// Nothing to run.
const DATA = new Set(["json", "yaml", "xml", "toml", "text"]);

export function blocks(text) {
    const found = [];
    let open;
    for (const [number, line] of text.split("\n").entries()) {
        const fence = line.match(/^\s*```(.*)/);
        if (!fence) continue;
        if (open === undefined) found.push({ info: (open = fence[1].trim()), line: number + 1 });
        else open = undefined;
    }
    return found;
}

test("every block of code has a runner, or says that it has none", () => {
    const unrun = [];
    let run = 0;
    for (const { path } of pages(contents()).values()) {
        if (REFERENCES[path]) continue;
        for (const { info, line } of blocks(source(path))) {
            const [language] = info.split(/[\s,]/);
            if (DATA.has(language) || /\bnot run\b/.test(info)) continue;
            if (RUNNERS[language]?.(path) || opensPage(path, info)) run += 1;
            else unrun.push(`${path}:${line} ${info || "(no language)"}`);
        }
    }
    assert.deepEqual(unrun, []);
    assert.ok(run > 60, `${run} blocks`);
});
