// Writes the documentation into dist/, next to the demo page: `node docs/build.js`.
import { copyFileSync, cpSync, mkdirSync, writeFileSync } from "node:fs";
import { resolve } from "node:path";
import { REFERENCES, contents, pages, root, rustdoc, source } from "./contents.js";
import { javascriptReference } from "./javascript_reference.js";
import { laidOut } from "./layout.js";
import { Links } from "./links.js";
import { rendered } from "./markdown.js";
import { pythonReference } from "./python_reference.js";

const dist = new URL("../dist/", import.meta.url);
const within = (path) => {
    const file = new URL(path, dist);
    mkdirSync(new URL(".", file), { recursive: true });
    return file;
};
const WRITTEN = { "python/reference.html": pythonReference, "web/reference.html": javascriptReference };

const groups = contents();
const all = pages(groups);
const pictures = new Set();
const links = new Links(all, pictures);
const searchEntries = [];
for (const page of all.values()) {
    const text = REFERENCES[page.path] ? WRITTEN[page.address]() : source(page.path);
    const { html, headings, sections } = rendered(text, page, links);
    for (const { heading, anchor, text: words } of sections) searchEntries.push([page.title, heading, `${page.address}#${anchor}`, words]);
    writeFileSync(within(page.address), laidOut({ page, html, headings, groups }));
}
for (const path of pictures) copyFileSync(new URL(path, root), within(path));
for (const file of ["page.css", "page.js", "search.js"]) copyFileSync(new URL(file, import.meta.url), within(`docs/${file}`));
if (rustdoc) cpSync(resolve(rustdoc), new URL("rust/", dist), { recursive: true });
writeFileSync(within("docs/search.json"), JSON.stringify(searchEntries));
console.log(`web/site/dist: ${all.size} pages of documentation, ${pictures.size} pictures`);
