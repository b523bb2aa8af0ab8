// Contents of the site: the pages that docs/README.md lists, in its groups and order.
import { readFileSync } from "node:fs";
import { posix } from "node:path";

export const root = new URL("../../../", import.meta.url);
export const source = (path) => readFileSync(new URL(path, root), "utf8");
export const repository = source("Cargo.toml").match(/^repository = "(.*)"/m)[1];

const LIST = "docs/README.md";

/** Pages generated from the sources of an interface, by the link target in docs/README.md. */
export const REFERENCES = { "python/stubs/__init__.pyi": "python/reference.html", "web/src": "web/reference.html" };

/**
 * Address of a repository page on the site. A README is its folder's index page. The main README is not, because the
 * demo page is the index there.
 */
export function addressOf(path) {
    if (path === "README.md") return "readme.html";
    return path.replace(/(^|\/)README\.md$/, "$1index.html").replace(/[^/]*\.md$/, (name) => `${name.slice(0, -3).toLowerCase()}.html`);
}

/**
 * Groups of entries: a title with an address on the site, an anchor there and the path of its source, or an external
 * address.
 */
export function contents() {
    const groups = [];
    for (const line of source(LIST).split("\n")) {
        const heading = line.match(/^## (.*)/);
        if (heading) groups.push({ title: heading[1], entries: [] });
        const entry = line.match(/^- \[([^\]]+)\]\(([^)#\s]+)(#[^)\s]+)?\)/);
        if (entry) groups.at(-1).entries.push({ title: entry[1], anchor: entry[3] ?? "", ...entryTarget(entry[2]) });
    }
    return groups;
}

/** Folder of rustdoc's output, if set: its pages are then part of the site. */
export const rustdoc = process.env.KINOPT_RUSTDOC;

function entryTarget(link) {
    if (rustdoc && link === "https://docs.rs/kinopt") return { address: "rust/kinopt/index.html" };
    if (/^https?:/.test(link)) return { external: link };
    const path = posix.join(posix.dirname(LIST), link).replace(/\/$/, "");
    return { path, address: REFERENCES[path] ?? addressOf(path) };
}

/**
 * Pages by the path of their source: the list itself, the entries of its groups, and further pages that it links to.
 */
export function pages(groups) {
    const listed = groups.flatMap(({ entries }) => entries).filter(({ path, anchor }) => path && !anchor);
    const named = [...source(LIST).matchAll(/\[([^\]]+)\]\(([^)#\s]+\.md)\)/g)].map(([, title, link]) => ({ title, ...entryTarget(link) }));
    const all = [{ title: "Documentation", path: LIST, address: addressOf(LIST) }, ...listed, ...named];
    return new Map(all.reverse().map((page) => [page.path, page]));
}
