// Conversion of a page's links and pictures to addresses on the site.
import { existsSync, statSync } from "node:fs";
import { posix } from "node:path";
import { repository, root } from "./contents.js";

const REPOSITORY_LINK = new RegExp(`^(?:${repository}/(?:blob|tree|raw)/main|${repository.replace("//github.com", "//raw.githubusercontent.com")}/main)/`);

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
        const [target, anchor = ""] = link.split(/(?=#)/);
        if (REPOSITORY_LINK.test(target)) return { path: target.replace(REPOSITORY_LINK, ""), anchor };
        if (/^[a-z]+:/i.test(target) || target === "") return undefined;
        return { path: posix.join(posix.dirname(page.path), decodeURI(target)).replace(/\/$/, ""), anchor };
    }

    /** Path of a link into the repository. */
    pathOf(page, link) {
        return this.#path(page, link)?.path;
    }

    /** Title of the page that a link leads to, if it is a page of the site. */
    titleOf(page, link) {
        return this.pages.get(this.#path(page, link)?.path)?.title;
    }

    #stat(page, path) {
        const file = new URL(path, root);
        if (!existsSync(file)) throw new Error(`${page.path} links to ${path}, which does not exist`);
        return statSync(file);
    }

    link(page, link) {
        const resolved = this.#path(page, link);
        if (!resolved) return link;
        const target = this.pages.get(resolved.path);
        if (target) return between(page.address, target.address) + resolved.anchor;
        const kind = this.#stat(page, resolved.path).isDirectory() ? "tree" : "blob";
        return `${repository}/${kind}/main/${resolved.path}${resolved.anchor}`;
    }

    picture(page, link) {
        const resolved = this.#path(page, link);
        if (!resolved) return link;
        this.#stat(page, resolved.path);
        this.pictures.add(resolved.path);
        return between(page.address, resolved.path);
    }
}
