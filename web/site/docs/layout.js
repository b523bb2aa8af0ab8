// Frame of every page: header, contents, headings of the page, next and previous page.
import { repository } from "./contents.js";
import { between } from "./links.js";

const escape = (text) => text.replace(/[&<>"]/g, (c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[c]);

function entry(page, { title, address, anchor = "", external }) {
    if (external) return `<li><a href="${external}">${escape(title)}</a></li>`;
    const current = address === page.address && !anchor ? ' aria-current="page"' : "";
    return `<li><a href="${between(page.address, address)}${anchor}"${current}>${escape(title)}</a></li>`;
}

const group = (page) => ({ title, entries }) => `<h2>${escape(title)}</h2>\n<ul>\n${entries.map((target) => entry(page, target)).join("\n")}\n</ul>`;

function onThisPage(headings) {
    const parts = headings.filter(({ level }) => level === 2);
    if (parts.length < 2) return "";
    const list = parts.map(({ text, anchor }) => `<li><a href="#${anchor}">${escape(text)}</a></li>`).join("\n");
    return `<aside aria-label="On this page">\n<h2>On this page</h2>\n<ul>\n${list}\n</ul>\n</aside>`;
}

function neighbours(page, groups) {
    const order = groups.flatMap(({ entries }) => entries).filter(({ path, anchor }) => path && !anchor);
    const index = order.findIndex(({ address }) => address === page.address);
    const linkTo = (target, rel, label) => target ? `<a rel="${rel}" href="${between(page.address, target.address)}"><small>${label}</small>${escape(target.title)}</a>` : "<span></span>";
    return `<nav class="neighbours" aria-label="Next pages">${linkTo(index > 0 && order[index - 1], "prev", "Previous")}${linkTo(order[index + 1], "next", "Next")}</nav>`;
}

/** True if a table is too wide for the text column: many columns with long rows. */
const hasWideTable = (html) => html.split("<table>").slice(1).some((part) => {
    const rows = part.split("</table>")[0].split("</tr>").map((row) => row.replace(/<[^>]*>|&[a-z]+;/g, ""));
    return part.split("</thead>")[0].split("<th").length > 6 && rows.some((row) => row.length > 150);
});

/** First paragraph of a page without markup. */
function firstWords(html) {
    const [, first = ""] = html.match(/<p>([\s\S]*?)<\/p>/) ?? [];
    const text = first.replace(/<[^>]*>/g, "").replace(/\s+/g, " ").replace(/&quot;/g, '"').replace(/&lt;/g, "<").replace(/&gt;/g, ">").replace(/&amp;/g, "&");
    return text.length > 160 ? `${text.slice(0, 157).replace(/ \S*$/, "")} …` : text;
}

export function laidOut({ page, html, headings, groups }) {
    const at = (address) => between(page.address, address);
    const title = headings[0]?.text ?? page.title;
    const fullTitle = title === "kinopt" ? "kinopt" : `${title} · kinopt`;
    return `<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>${escape(fullTitle)}</title>
<meta name="description" content="${escape(firstWords(html))}">
<link rel="icon" href="data:,">
<link rel="stylesheet" href="${at("palette.css")}">
<link rel="stylesheet" href="${at("docs/page.css")}">
<script type="module" src="${at("docs/page.js")}"></script>
</head>
<body>
<a class="skip" href="#text">Skip to the text</a>
<header>
<a class="name" href="${at("index.html")}">kinopt</a>
<nav aria-label="Site"><a href="${at("index.html")}">Demo</a> <a href="${at("docs/index.html")}">Documentation</a> <a href="${repository}">Source</a></nav>
<a class="button" id="menu" href="#contents">Contents</a>
</header>
<div id="page"${hasWideTable(html) ? ' class="wide"' : ""}>
<nav id="contents" aria-label="Contents">
<ul>${entry(page, { title: "Overview", address: "docs/index.html" })}</ul>
${groups.map(group(page)).join("\n")}
</nav>
<main id="text">
${html}
${neighbours(page, groups)}
<footer><a href="${repository}/blob/main/${page.path}">Source of this page</a></footer>
</main>
${onThisPage(headings)}
</div>
</body>
</html>
`;
}
