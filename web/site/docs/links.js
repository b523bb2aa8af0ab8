// Conversion of a page's links and pictures to addresses on the site.
import { existsSync, statSync } from "node:fs";
import { posix } from "node:path";
import { repository, root } from "./contents.js";

const OWN = new RegExp(`^(?:${repository}/(?:blob|tree|raw)/main|${repository.replace("//github.com", "//raw.githubusercontent.com")}/main)/`);

/** Relative address from one page of the site to another. */
export const between = (from, to) => posix.relative(posix.dirname(from), to) || posix.basename(to);

/** Rewrites the links of a page; `pictures` collects the files to copy. */
export class Links {
    constructor(pages, pictures) {
        this.pages = pages;
        this.pictures = pictures;
    }

    /** Path in the repository of a link of a page, and its anchor; undefined for external addresses. */
    #path(page, link) {
        const [whole, anchor = ""] = link.split(/(?=#)/);
        if (OWN.test(whole)) return { path: whole.replace(OWN, ""), anchor };
        if (/^[a-z]+:/i.test(whole) || whole === "") return undefined;
        return { path: posix.join(posix.dirname(page.path), decodeURI(whole)).replace(/\/$/, ""), anchor };
    }

    /** Path of a link into the repository. */
    pathOf(page, link) {
        return this.#path(page, link)?.path;
    }

    /** Title of the page that a link leads to, if it is a page of the site. */
    titleOf(page, link) {
        return this.pages.get(this.#path(page, link)?.path)?.title;
    }

    #there(page, path) {
        const file = new URL(path, root);
        if (!existsSync(file)) throw new Error(`${page.path} links to ${path}, which does not exist`);
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
