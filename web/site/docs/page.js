// Behaviour of the documentation pages: language tabs, copy buttons, and a contents menu on small screens.
import { indexed, ranked } from "./search.js";

const LANGUAGE_KEY = "kinopt language";
const remembered = () => {
    try {
        return localStorage.getItem(LANGUAGE_KEY);
    } catch {
        return null; // pages opened as files have no storage
    }
};
const remember = (language) => {
    try {
        localStorage.setItem(LANGUAGE_KEY, language);
    } catch {
        // No storage, as above.
    }
};

/** Shows a language in every group that has it. */
function choose(language) {
    for (const group of document.querySelectorAll(".languages")) {
        const parts = [...group.querySelectorAll(":scope > section")];
        const shown = parts.find((part) => part.dataset.language === language);
        if (!shown) continue;
        for (const part of parts) part.hidden = part !== shown;
        for (const tab of group.querySelectorAll('[role="tab"]')) {
            const isSelected = tab.textContent === language;
            tab.setAttribute("aria-selected", String(isSelected));
            tab.tabIndex = isSelected ? 0 : -1;
        }
    }
}

for (const [number, group] of document.querySelectorAll(".languages").entries()) {
    const tabs = document.createElement("div");
    tabs.setAttribute("role", "tablist");
    tabs.setAttribute("aria-label", "Language");
    for (const part of group.querySelectorAll(":scope > section")) {
        const { language } = part.dataset;
        const tab = document.createElement("button");
        tab.textContent = language;
        tab.setAttribute("role", "tab");
        tab.id = `tab-${number}-${language}`;
        part.id = `part-${number}-${language}`;
        tab.setAttribute("aria-controls", part.id);
        part.setAttribute("role", "tabpanel");
        part.setAttribute("aria-labelledby", tab.id);
        tab.addEventListener("click", () => {
            // Groups above may change their height: the clicked tab stays under the pointer.
            const previousTop = tab.getBoundingClientRect().top;
            choose(language);
            remember(language);
            scrollBy({ top: tab.getBoundingClientRect().top - previousTop, behavior: "instant" });
        });
        tabs.append(tab);
    }
    tabs.addEventListener("keydown", (event) => {
        const direction = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
        if (!direction) return;
        const all = [...tabs.children];
        const next = all[(all.indexOf(document.activeElement) + direction + all.length) % all.length];
        next.click();
        next.focus();
    });
    group.prepend(tabs);
    group.classList.add("one");
    choose(group.querySelector("section").dataset.language);
}
const language = remembered();
if (language) choose(language);

for (const code of document.querySelectorAll("figure.code")) {
    const copy = document.createElement("button");
    copy.className = "copy";
    copy.textContent = "Copy";
    copy.addEventListener("click", async () => {
        await navigator.clipboard.writeText(code.querySelector("code").textContent);
        copy.textContent = "Copied";
        setTimeout(() => (copy.textContent = "Copy"), 1500);
    });
    code.append(copy);
}

const menu = document.querySelector("#menu");
const contents = document.querySelector("#contents");
menu.setAttribute("role", "button");
menu.setAttribute("aria-expanded", "false");
const open = (whether) => {
    contents.classList.toggle("open", whether);
    menu.setAttribute("aria-expanded", String(whether));
};
document.body.classList.add("scripted");
menu.addEventListener("click", (event) => {
    event.preventDefault();
    open(!contents.classList.contains("open"));
    if (contents.classList.contains("open")) contents.querySelector("input, a").focus({ preventScroll: true });
});
contents.addEventListener("keydown", (event) => {
    if (event.key !== "Escape") return;
    open(false);
    menu.focus();
});
const search = document.createElement("input");
search.type = "search";
search.placeholder = "Search";
search.setAttribute("aria-label", "Search the documentation");
const results = document.createElement("ul");
results.id = "results";
results.setAttribute("aria-live", "polite");
contents.prepend(search, results);
const root = new URL("../", import.meta.url);
let loading;
const load = async () => indexed(await (await fetch(new URL("docs/search.json", root))).json());
const sections = () => (loading ??= load());
search.addEventListener("focus", sections);
search.addEventListener("input", async () => {
    const query = search.value.trim();
    const scored = query ? ranked(await sections(), query) : [];
    results.replaceChildren(...scored.slice(0, 12).map(({ page, heading, address }) => {
        const [item, link, pageName] = ["li", "a", "small"].map((kind) => document.createElement(kind));
        link.href = new URL(address, root);
        link.textContent = heading;
        pageName.textContent = page === heading ? "" : page;
        link.append(pageName);
        item.append(link);
        return item;
    }));
    if (query && !scored.length) results.textContent = "No results.";
    contents.classList.toggle("searching", query !== "");
});
search.addEventListener("keydown", (event) => {
    if (event.key === "Enter") results.querySelector("a")?.click();
});
addEventListener("keydown", (event) => {
    if (event.key !== "/" || /^(INPUT|TEXTAREA)$/.test(document.activeElement.tagName)) return;
    event.preventDefault();
    open(true);
    search.focus();
});

contents.querySelector('[aria-current="page"]')?.scrollIntoView({ block: "nearest" });
