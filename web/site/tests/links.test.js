// Every link of the built site has a target: pages, anchors, pictures. External addresses are listed but not requested,
// because the gate may be offline.
import assert from "node:assert/strict";
import { mkdirSync, mkdtempSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import test from "node:test";
import { fileURLToPath } from "node:url";
import { checked } from "../docs/check_links.js";
import { contents, pages, root } from "../docs/contents.js";

const dist = fileURLToPath(new URL("../dist/", import.meta.url));

test("every link of the site has a target", () => {
    const { broken, elsewhere, links } = checked(dist);
    assert.deepEqual(broken, []);
    assert.ok(links > 1000, `${links} links`);
    console.log(`${links} links; ${elsewhere.size} addresses elsewhere, not asked:\n${[...elsewhere].sort().join("\n")}`);
});

test("contents and demo page link to every page of docs/", () => {
    const all = pages(contents());
    const folders = ["docs", "docs/guide", "docs/reference"];
    const markdownFiles = folders.flatMap((folder) => readdirSync(new URL(`${folder}/`, root)).filter((name) => name.endsWith(".md")).map((name) => `${folder}/${name}`));
    assert.deepEqual(markdownFiles.filter((path) => !all.has(path)), []);
    assert.ok(checked(dist).from.get("index.html").has("docs/index.html"));
    assert.ok(checked(dist).from.get("docs/index.html").has("index.html"));
});

test("broken links are reported", () => {
    const site = mkdtempSync(join(tmpdir(), "site-"));
    try {
        mkdirSync(join(site, "docs"));
        writeFileSync(join(site, "index.html"), '<h1 id="here">1</h1><a href="docs/a.html#there">a</a><a href="#here">b</a><a href="https://example.org/">c</a>');
        const wrong = ["b.html", "../index.html#gone", "#gone", "../../outside.html", "."].map((link) => `<a href="${link}">a</a>`);
        writeFileSync(join(site, "docs/a.html"), `<h2 id="there">2</h2><a href="../index.html#here">c</a>${wrong.join("")}<img src="none.png"><h2 id="there">2</h2>`);
        const { broken, elsewhere } = checked(site);
        assert.deepEqual(broken.sort(), [
            "docs/a.html: #gone",
            "docs/a.html: .",
            "docs/a.html: ../../outside.html",
            "docs/a.html: ../index.html#gone",
            "docs/a.html: b.html",
            "docs/a.html: duplicate id there",
            "docs/a.html: none.png",
        ]);
        assert.deepEqual([...elsewhere], ["https://example.org/"]);
    } finally {
        rmSync(site, { recursive: true });
    }
});
