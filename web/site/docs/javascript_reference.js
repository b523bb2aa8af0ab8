// Reference of the npm package as a page of Markdown, from its types.
import { readFileSync } from "node:fs";

const read = (name) => readFileSync(new URL(`../../dist/${name}`, import.meta.url), "utf8");
const comment = (lines) => lines.map((line) => line.replace(/^\s*\/?\*+\/? ?/, "").replace(/\*\/$/, "").trimEnd()).join("\n").trim();

/** Members in the braces of a declaration, each with the comment before it. */
function members(lines) {
    const found = [];
    let said = [];
    let depth = 0;
    let signature = "";
    for (const line of lines) {
        if (!signature && /^\s*(\/\*\*|\*)/.test(line)) {
            said.push(line);
            continue;
        }
        signature += ` ${line.trim()}`;
        depth += (line.match(/[({[]/g) ?? []).length - (line.match(/[)}\]]/g) ?? []).length;
        if (depth > 0) continue;
        const own = signature.trim().replace(/;$/, "");
        if (own && !/^(private |free\(|\[Symbol)/.test(own)) found.push({ signature: own, told: comment(said) });
        [said, signature] = [[], ""];
    }
    return found;
}

/** Exported declarations of a file of types: name, kind, comment and members. */
export function declarations(text) {
    const found = [];
    const pattern = /((?:^\/\*\*[\s\S]*?\*\/\n)?)^export (?:declare )?(class|interface|type|function) (\w+)([\s\S]*?)(?=^\/\*\*|^export |^type |(?![\s\S]))/gm;
    for (const [, said, kind, name, rest] of text.matchAll(pattern)) {
        const body = rest.includes("{") && kind !== "function" ? rest.slice(rest.indexOf("{") + 1, rest.lastIndexOf("}")).split("\n") : [];
        found.push({ kind, name, told: comment(said.split("\n")), rest: rest.trim().replace(/;$/, ""), members: kind === "type" ? [] : members(body) });
    }
    return found;
}

const line = ({ signature, told }) => `- \`${signature}\`${told ? `  \n  ${told.replace(/\n+/g, " ")}` : ""}`;

export function javascriptReference() {
    const all = declarations(read("kinopt.d.ts")).filter(({ name }) => !/^(Sync)?Init|^init/.test(name));
    const functions = ["placement.d.ts", "tasks.d.ts"].map((name) => declarations(read(name)).filter(({ kind }) => kind === "function"));
    const asLine = (own, prefix = "") => line({ signature: `${prefix}${own.name}${own.rest.replace(/\s+/g, " ").replace("( ", "(").replace(", )", ")")}`, told: own.told });
    const text = ["# JavaScript reference", "", "Exports of the npm package `kinopt`, with their types. Their use is shown on [the package's page](https://github.com/kinopt/kinopt/blob/main/web/README.md).", ""];
    for (const kind of ["class", "interface", "type"]) {
        for (const own of all.filter((one) => one.kind === kind).sort((a, b) => (a.name < b.name ? -1 : 1))) {
            text.push(`## ${own.name}`, "", own.told, "");
            const made = own.members.filter(({ signature }) => signature.startsWith("constructor("));
            for (const { signature, told } of made) text.push("```ts", signature.replace("constructor", `new ${own.name}`), "```", "", told, "");
            if (kind === "type") text.push(`- \`${own.rest.replace(/^=\s*/, "").replace(/\s+/g, " ")}\``);
            text.push(...own.members.filter((one) => !made.includes(one)).map(line), "");
        }
    }
    text.push("## tasks", "", "Tasks of `new Problem(model, tasks)`.", "", ...functions[1].map((own) => asLine(own, "tasks.")), "");
    text.push("## Functions", "", ...[...functions[0], ...all.filter(({ kind }) => kind === "function")].map((own) => asLine(own)), "");
    return text.join("\n");
}
