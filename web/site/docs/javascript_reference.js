// Reference of the npm package as a page of Markdown, from its types.
import { readFileSync } from "node:fs";

const read = (name) => readFileSync(new URL(`../../dist/${name}`, import.meta.url), "utf8");
const comment = (lines) => lines.map((line) => line.replace(/^\s*\/?\*+\/? ?/, "").replace(/\*\/$/, "").trimEnd()).join("\n").trim();

/** Members in the braces of a declaration, each with the comment before it. */
function members(lines) {
    const results = [];
    let commentLines = [];
    let depth = 0;
    let signature = "";
    for (const line of lines) {
        if (!signature && /^\s*(\/\*\*|\*)/.test(line)) {
            commentLines.push(line);
            continue;
        }
        signature += ` ${line.trim()}`;
        depth += (line.match(/[({[]/g) ?? []).length - (line.match(/[)}\]]/g) ?? []).length;
        if (depth > 0) continue;
        const member = signature.trim().replace(/;$/, "");
        if (member && !/^(private |free\(|\[Symbol)/.test(member)) results.push({ signature: member, doc: comment(commentLines) });
        [commentLines, signature] = [[], ""];
    }
    return results;
}

/** Exported declarations of a file of types: name, kind, comment and members. */
export function declarations(text) {
    const results = [];
    const pattern = /((?:^\/\*\*[\s\S]*?\*\/\n)?)^export (?:declare )?(class|interface|type|function) (\w+)([\s\S]*?)(?=^\/\*\*|^export |^type |(?![\s\S]))/gm;
    for (const [, commentText, kind, name, rest] of text.matchAll(pattern)) {
        const body = rest.includes("{") && kind !== "function" ? rest.slice(rest.indexOf("{") + 1, rest.lastIndexOf("}")).split("\n") : [];
        results.push({ kind, name, doc: comment(commentText.split("\n")), rest: rest.trim().replace(/;$/, ""), members: kind === "type" ? [] : members(body) });
    }
    return results;
}

const line = ({ signature, doc }) => `- \`${signature}\`${doc ? `  \n  ${doc.replace(/\n+/g, " ")}` : ""}`;

export function javascriptReference() {
    const all = ["kinopt.d.ts", "errors.d.ts"].flatMap((name) => declarations(read(name))).filter(({ name }) => !/^(Sync)?Init|^init/.test(name));
    const functions = ["placement.d.ts", "tasks.d.ts"].map((name) => declarations(read(name)).filter(({ kind }) => kind === "function"));
    const asLine = (item, prefix = "") => line({ signature: `${prefix}${item.name}${item.rest.replace(/\s+/g, " ").replace("( ", "(").replace(", )", ")")}`, doc: item.doc });
    const text = ["# JavaScript reference", "", "Exports of the npm package `kinopt`, with their types. Their use is shown on [the package's page](https://github.com/kinopt/kinopt/blob/main/web/README.md).", ""];
    for (const kind of ["class", "interface", "type"]) {
        for (const item of all.filter((member) => member.kind === kind).sort((a, b) => (a.name < b.name ? -1 : 1))) {
            text.push(`## ${item.name}`, "", item.doc, "");
            const constructors = item.members.filter(({ signature }) => signature.startsWith("constructor("));
            for (const { signature, doc } of constructors) text.push("```ts", signature.replace("constructor", `new ${item.name}`), "```", "", doc, "");
            if (kind === "type") text.push(`- \`${item.rest.replace(/^=\s*/, "").replace(/\s+/g, " ")}\``);
            text.push(...item.members.filter((member) => !constructors.includes(member)).map(line), "");
        }
    }
    text.push("## tasks", "", "Tasks of `new Problem(model, tasks)`.", "", ...functions[1].map((item) => asLine(item, "tasks.")), "");
    text.push("## Functions", "", ...[...functions[0], ...all.filter(({ kind }) => kind === "function")].map((item) => asLine(item)), "");
    return text.join("\n");
}
