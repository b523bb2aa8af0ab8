// Markdown to HTML: anchors as on GitHub, highlighted code, tabs for equivalent code in several languages.
import { readFileSync } from "node:fs";
import highlighter from "highlight.js/lib/core";
import bash from "highlight.js/lib/languages/bash";
import ini from "highlight.js/lib/languages/ini";
import javascript from "highlight.js/lib/languages/javascript";
import json from "highlight.js/lib/languages/json";
import python from "highlight.js/lib/languages/python";
import rust from "highlight.js/lib/languages/rust";
import typescript from "highlight.js/lib/languages/typescript";
import xml from "highlight.js/lib/languages/xml";
import MarkdownIt from "markdown-it";
import { root } from "./contents.js";

const LANGUAGES = { rust: "Rust", python: "Python", js: "JavaScript", sh: "Command", json: "JSON", yaml: "YAML", xml: "XML", text: "Text" };
for (const [name, grammar] of Object.entries({ bash, ini, javascript, json, python, rust, typescript, xml })) highlighter.registerLanguage(name, grammar);
const GRAMMARS = { sh: "bash", js: "javascript", ts: "typescript", yaml: "ini", toml: "ini" };

const markdown = new MarkdownIt({ html: false, linkify: false, typographer: false });
const escape = markdown.utils.escapeHtml;

/** Anchor of a heading; `seen` counts repeated headings of the page. */
export function anchorOf(text, seen) {
    const plain = text.trim().toLowerCase().replace(/[^\p{L}\p{N}\s_-]/gu, "").replace(/\s/g, "-");
    const before = seen.get(plain) ?? 0;
    seen.set(plain, before + 1);
    return before ? `${plain}-${before}` : plain;
}

/** Removes the lines that rustdoc hides. */
const withoutHidden = (code) => code.split("\n").filter((line) => !/^\s*#( |$)/.test(line)).join("\n");

export function coloured(code, language) {
    const grammar = GRAMMARS[language] ?? language;
    return highlighter.getLanguage(grammar) ? highlighter.highlight(code, { language: grammar }).value : escape(code);
}

function block(token) {
    const [language = "text"] = token.info.trim().split(/[\s,]+/);
    const code = language === "rust" ? withoutHidden(token.content) : token.content;
    return `<figure class="code"><pre tabindex="0"><code class="language-${escape(language)}">${coloured(code.trimEnd(), language)}\n</code></pre></figure>\n`;
}

const named = (token) => LANGUAGES[token.info.trim().split(/[\s,]+/)[0]];

// Consecutive blocks in different languages are equivalent: one of them is shown.
markdown.core.ruler.push("languages", ({ tokens, Token }) => {
    for (let begin = 0; begin < tokens.length; begin += 1) {
        let end = begin;
        const languages = new Set();
        while (tokens[end]?.type === "fence" && tokens[end].level === 0 && named(tokens[end]) && !languages.has(named(tokens[end]))) languages.add(named(tokens[end++]));
        if (languages.size < 2) continue;
        const group = new Token("languages", "div", 0);
        group.children = tokens.splice(begin, end - begin);
        tokens.splice(begin, 0, group);
    }
});
markdown.renderer.rules.languages = (tokens, index) => {
    const parts = tokens[index].children.map((token) => `<section data-language="${named(token)}" aria-label="${named(token)}">${block(token)}</section>`);
    return `<div class="languages">${parts.join("")}</div>\n`;
};
markdown.renderer.rules.fence = (tokens, index) => block(tokens[index]);
markdown.renderer.rules.code_block = (tokens, index) => block({ info: "text", content: tokens[index].content });
// The digit groups of a large number are not separated by a line break.
markdown.renderer.rules.text = (tokens, index) => markdown.utils.escapeHtml(tokens[index].content.replace(/(\d) (?=\d{3}\b)/g, "$1\u00a0"));
markdown.renderer.rules.table_open = () => '<div class="table" tabindex="0" role="region" aria-label="Table"><table>\n';
markdown.renderer.rules.table_close = () => "</table></div>\n";

// Links and pictures are converted for the site; headings get anchors.
markdown.core.ruler.push("site", ({ tokens, env }) => {
    env.headings = [];
    const seen = new Map();
    for (const [index, token] of tokens.entries()) {
        for (const [at, child] of (token.children ?? []).entries()) {
            if (child.type === "link_open") linked(child, token.children[at + 1], env);
            if (child.type === "image") picture(child, env);
        }
        if (token.type !== "heading_open") continue;
        const inline = tokens[index + 1];
        const text = inline.children.filter(({ type }) => /text|code_inline/.test(type)).map(({ content }) => content).join("");
        const anchor = anchorOf(text, seen);
        token.attrSet("id", anchor);
        env.headings.push({ level: Number(token.tag[1]), text, anchor });
    }
});
markdown.renderer.rules.heading_close = (tokens, index) => {
    const anchor = tokens[index - 2].attrGet("id");
    return ` <a class="anchor" href="#${anchor}" aria-label="Link to this section">#</a></${tokens[index].tag}>\n`;
};

/** Rewrites a link; if its text is the file name of a page, the page's title replaces the text. */
function linked(link, shown, env) {
    const to = link.attrGet("href");
    if (/^[\w./-]+\.md$/.test(shown.content)) shown.content = env.links.titleOf(env.page, to) ?? shown.content;
    link.attrSet("href", env.links.link(env.page, to));
}

function picture(image, env) {
    const source = image.attrGet("src");
    image.attrSet("src", env.links.picture(env.page, source));
    image.attrSet("loading", "lazy");
    image.attrSet("decoding", "async");
    const size = sizeOf(env.links.pathOf(env.page, source));
    if (size) for (const [name, value] of Object.entries(size)) image.attrSet(name, String(value));
}

/** Size of a picture, so that the page does not shift when it loads. */
function sizeOf(path) {
    if (!path) return undefined;
    const bytes = readFileSync(new URL(path, root));
    if (path.endsWith(".png")) return { width: bytes.readUInt32BE(16), height: bytes.readUInt32BE(20) };
    if (path.endsWith(".gif")) return { width: bytes.readUInt16LE(6), height: bytes.readUInt16LE(8) };
    const [, width, height] = bytes.toString("utf8", 0, 400).match(/<svg[^>]* width="(\d+)" height="(\d+)"/) ?? [];
    return width ? { width, height } : undefined;
}

/** Text below each heading, for the search. */
function sectionsOf(tokens, headings) {
    const sections = [];
    let next = 0;
    for (const token of tokens) {
        if (token.type === "heading_open") sections.push({ heading: headings[next].text, anchor: headings[next++].anchor, text: "" });
        const content = token.type === "languages" ? token.children.map((one) => one.content).join("\n") : token.content;
        if (content && sections.length) sections.at(-1).text += `${content}\n`;
    }
    return sections;
}

/** HTML of a page, its headings, and the text below each heading. */
export function rendered(text, page, links) {
    const env = { page, links };
    const tokens = markdown.parse(text, env);
    const sections = sectionsOf(tokens, env.headings);
    return { html: markdown.renderer.render(tokens, markdown.options, env), headings: env.headings, sections };
}
