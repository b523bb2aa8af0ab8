// Broken links of a built site.
import { existsSync, readFileSync, readdirSync, statSync } from "node:fs";
import { join, posix } from "node:path";

const plain = (text) => text.replace(/&amp;/g, "&").replace(/&quot;/g, '"').replace(/&lt;/g, "<").replace(/&gt;/g, ">");

/** Links and anchors of a page; duplicate anchors are among the faults. */
function read(text) {
    const markup = text.replace(/<script[\s\S]*?<\/script>/g, (script) => script.slice(0, script.indexOf(">") + 1));
    const attributes = (names) => [...markup.matchAll(new RegExp(`<[^>]*?\\s(?:${names})="([^"]*)"`, "g"))].map(([, value]) => plain(value));
    const ids = attributes("id");
    return { links: [...attributes("href"), ...attributes("src")], ids: new Set(ids), twice: ids.filter((id, k) => ids.indexOf(id) !== k) };
}

/** Checks every page below a folder except those of rustdoc, which has its own check. */
export function checked(folder) {
    const names = readdirSync(folder, { recursive: true }).map((name) => name.replace(/\\/g, "/")).filter((name) => name.endsWith(".html") && !name.startsWith("rust/"));
    const pages = new Map(names.map((name) => [name, read(readFileSync(join(folder, name), "utf8"))]));
    const [broken, elsewhere, from] = [[], new Set(), new Map()];
    let links = 0;
    for (const [name, page] of pages) {
        from.set(name, new Set());
        broken.push(...page.twice.map((id) => `${name}: duplicate id ${id}`));
        for (const link of page.links) {
            links += 1;
            if (/^(data|mailto):/.test(link)) continue;
            if (/^[a-z]+:/i.test(link)) {
                elsewhere.add(link);
                continue;
            }
            const [path, anchor] = link.split("#");
            const target = path === "" ? name : posix.join(posix.dirname(name), decodeURI(path));
            from.get(name).add(target);
            const exists = !target.startsWith("..") && existsSync(join(folder, target)) && statSync(join(folder, target)).isFile();
            if (!exists || (anchor && !pages.get(target)?.ids.has(decodeURIComponent(anchor)))) broken.push(`${name}: ${link}`);
        }
    }
    return { broken, elsewhere, from, links };
}
