// What a link or a picture of a page's source is on the site.
import { existsSync, statSync } from "node:fs";
import { posix } from "node:path";
import { repository, root } from "./contents.js";

const OWN = new RegExp(`^(?:${repository}/(?:blob|tree|raw)/main|${repository.replace("//github.com", "//raw.githubusercontent.com")}/main)/`);

/** From one place on the site to another. */
export const between = (from, to) => posix.relative(posix.dirname(from), to) || posix.basename(to);

/** Rewrites the links of a page; `pictures` collects what is to be copied. */
export class Links {
    constructor(pages, pictures) {
        this.pages = pages;
        this.pictures = pictures;
    }

    /** The path in the repository that a link from a page means, and what follows it; nothing for addresses elsewhere. */
    #path(page, link) {
        const [whole, anchor = ""] = link.split(/(?=#)/);
        if (OWN.test(whole)) return { path: whole.replace(OWN, ""), anchor };
        if (/^[a-z]+:/i.test(whole) || whole === "") return undefined;
        return { path: posix.join(posix.dirname(page.path), decodeURI(whole)).replace(/\/$/, ""), anchor };
    }

    /** The path of what is the repository's own. */
    pathOf(page, link) {
        return this.#path(page, link)?.path;
    }

    /** The title of the page that a link leads to, if it leads to one. */
    titleOf(page, link) {
        return this.pages.get(this.#path(page, link)?.path)?.title;
    }

    #there(page, path) {
        const file = new URL(path, root);
        if (!existsSync(file)) throw new Error(`${page.path} links to ${path}, which is not there`);
        return statSync(file);
    }

    link(page, link) {
        const own = this.#path(page, link);
        if (!own) return link;
        const target = this.pages.get(own.path);
        if (target) return between(page.address, target.address) + own.anchor;
        const kind = this.#there(page, own.path).isDirectory() ? "tree" : "blob";
        return `${repository}/${kind}/main/${own.path}${own.anchor}`;
    }

    picture(page, link) {
        const own = this.#path(page, link);
        if (!own) return link;
        this.#there(page, own.path);
        this.pictures.add(own.path);
        return between(page.address, own.path);
    }
}
