// Reference of the Python package as a page of Markdown: signatures from its stubs, texts from the doc comments and
// docstrings.
import { readdirSync } from "node:fs";
import { root, source } from "./contents.js";

/** Each module with its stub, and the file or folder of its Python sources. */
const MODULES = [
    ["kinopt", "__init__.py", "__init__", ["motion.py", "placements.py", "errors.py"]],
    ["kinopt.tasks", "tasks.py", "tasks", ["tasks.py"]],
    ["kinopt.methods", "methods.py", undefined, ["methods.py"]],
    ["kinopt.animation", "animation.py", "animation", ["animation.py"]],
    ["kinopt.skinning", "skinning.py", "skinning", ["skinning.py"]],
    ["kinopt.io", "io.py", "io", ["io.py"]],
    ["kinopt.retargeting", "retargeting/__init__.py", "retargeting", filesIn("retargeting")],
    ["kinopt.models", "models/__init__.py", undefined, ["models/__init__.py"]],
    ["kinopt.view", "view/__init__.py", undefined, filesIn("view")],
    ["kinopt.ray", "ray/__init__.py", undefined, filesIn("ray")],
    ["kinopt.torch", "torch.py", undefined, ["torch.py"]],
    ["kinopt.jax", "jax.py", undefined, ["jax.py"]],
    ["kinopt.lerobot", "lerobot.py", undefined, ["lerobot.py"]],
    ["kinopt.rerun", "rerun.py", undefined, ["rerun.py"]],
];

function filesIn(folder) {
    const files = readdirSync(new URL(`python/kinopt/${folder}/`, root));
    return files.filter((file) => file.endsWith(".py")).sort().map((file) => `${folder}/${file}`);
}

/** Doc comments of Python classes and functions in the Rust sources, by class, and by class and member. */
function wordsOfRust() {
    const words = new Map();
    const files = readdirSync(new URL("python/src/", root), { recursive: true }).filter((file) => file.endsWith(".rs")).sort();
    for (const file of files) {
        let docLines = [];
        let scope = "";
        let named;
        for (const line of source(`python/src/${file}`).split("\n")) {
            const text = line.trim();
            const docLine = text.match(/^\/\/\/ ?(.*)/);
            const keep = (name) => {
                if (docLines.length && !words.has(name)) words.set(name, docLines.join("\n"));
                [docLines, named] = [[], undefined];
            };
            if (docLine) docLines.push(docLine[1]);
            else if (text.startsWith("#[")) named = text.match(/name = "(\w+)"|#\[getter\((\w+)\)\]/)?.slice(1).find(Boolean) ?? named;
            else if (/^impl\b/.test(line)) [scope, docLines] = [line.match(/^impl(?:<[^>]*>)? (?:\w+ for )?(\w+)/)?.[1] ?? "", []];
            else if (/^(pub(\(\w+\))? )?struct /.test(line)) {
                scope = line.match(/struct (\w+)/)[1];
                keep(scope);
            } else if (/\bfn (r#)?\w+/.test(text) && docLines.length) keep(`${/^\s/.test(line) ? `${scope}.` : ""}${named ?? text.match(/fn (?:r#)?(\w+)/)[1]}`);
            else if (/^(pub(\(\w+\))? )?\w+: /.test(text)) keep(`${scope}.${text.match(/(\w+):/)[1]}`);
            else if (text === "" || text === "}") [docLines, named] = [[], undefined];
        }
    }
    for (const [name, file] of [["Arm", "arm"], ["Solver", "solver"]]) {
        words.set(name, words.get(name).replace("Raises ", `${optionsOfRust(file)}\n\nRaises `));
    }
    return words;
}

/** Documentation of a table of options in kinopt-bindings, which the classes of the package have too. */
function optionsOfRust(file) {
    const rows = source(`crates/kinopt-bindings/src/option/${file}.rs`).matchAll(/name: "(\w+)",[\s\S]*?doc: "((?:[^"\\]|\\[\s\S])*)",\s*default: "((?:[^"\\]|\\[\s\S])*)"/g);
    const text = (literal) => literal.replace(/\\\n\s*/g, "").replaceAll('\\"', '"');
    return [...rows].map(([, name, doc, byDefault]) => `${name}: ${text(doc)} Default: ${text(byDefault)}.`).join("\n");
}

/** Statements of a stub or a module; those over several lines are joined. */
function statements(text) {
    const joined = [];
    let depth = 0;
    for (const line of text.split("\n")) {
        if (depth > 0) joined[joined.length - 1] += ` ${line.trim()}`;
        else joined.push(line);
        depth += (line.match(/[([{]/g) ?? []).length - (line.match(/[)\]}]/g) ?? []).length;
    }
    return joined.map((line) => line.replace(/\( /g, "(").replace(/,? \)/g, ")"));
}

/** Doc text as Markdown: names as code; lines about keywords become a list. */
function plain(words = "") {
    const lines = [];
    let listed = false;
    for (const text of words.replace(/(?<!`)``(?!`)/g, "`").split("\n")) {
        const keyword = text.match(/^([a-z_]+(?:, [a-z_]+)*): (\S.*)/);
        const begins = keyword && (listed || (lines.at(-1) ?? "") === "");
        lines.push(begins ? `- \`${keyword[1]}\`: ${keyword[2]}` : text);
        listed = Boolean(begins) || (listed && text.startsWith("    "));
    }
    return lines.join("\n").trim();
}

const line = (signature, doc) => `- \`${signature}\`${doc ? `  \n  ${plain(doc).replace(/\s*\n\s*/g, " ")}` : ""}`;
const signature = (definition) => definition.trim().replace(/^def /, "").replace(/\((cls|self)(, )?/, "(").replace(/:\s*\.\.\.$/, "");

/** A signature as a code block; a long one has a line for each parameter. */
function block(text) {
    const [, name, inside, rest] = text.match(/^(\w+)\(([\s\S]*)\)((?: -> .*)?)$/) ?? [];
    if (text.length < 90 || !inside) return ["```python", text, "```", ""];
    const parameters = inside.split(/, (?![^[(]*[\])])/).map((parameter) => `    ${parameter},`);
    return ["```python", `${name}(`, ...parameters, `)${rest}`, "```", ""];
}

function ofStub(file, words) {
    const entries = [];
    let currentClass;
    let property = false;
    for (const statement of file ? statements(source(`python/stubs/${file}.pyi`)) : []) {
        const kind = statement.match(/^class (\w+)/);
        if (kind) entries.push((currentClass = { name: kind[1], doc: words.get(kind[1]), members: [] }));
        else if (/^def /.test(statement)) {
            const name = statement.match(/^def (\w+)/)[1];
            entries.push({ name, doc: words.get(name), signature: signature(statement), members: [] });
            currentClass = undefined;
        } else if (/^\s+@property/.test(statement)) property = true;
        else if (/^\s+def /.test(statement) && currentClass) {
            const name = statement.match(/def (\w+)/)[1];
            const definition = signature(statement);
            if (name === "__new__") currentClass.signature = definition.replace("__new__", currentClass.name).replace(/ -> \w+$/, "");
            else if (!name.startsWith("_")) currentClass.members.push(line(property ? definition.replace("()", "").replace(" -> ", ": ") : definition, words.get(`${currentClass.name}.${name}`)));
            property = false;
        }
    }
    return entries;
}

/** Classes and functions of a Python source, with their docstrings. */
function ofFile(file) {
    const text = source(`python/kinopt/${file}`);
    const entries = [];
    for (const [declaration, kind, name, parameters, doc] of text.matchAll(/^(class|def) ([A-Za-z]\w*)(?:\(([\s\S]*?)\))?(?: -> [^\n]*)?:\n    """([\s\S]*?)"""/gm)) {
        const entry = { name, doc: doc.replace(/^ {4}/gm, ""), members: [] };
        if (kind === "def") entry.signature = `${name}(${parameters.replace(/\s+/g, " ").replace(/,? *$/, "").trim()})`;
        else {
            const body = text.slice(text.indexOf(declaration) + declaration.length).split(/\n(?=[^\s#)])/)[0];
            for (const [, property, member, arguments_, result, memberDoc] of body.matchAll(/^    (@property\n    )?def ([a-z]\w*)\(([\s\S]*?)\)(?: -> ([^\n]*))?:\n        """([\s\S]*?)"""/gm)) {
                const memberParameters = arguments_.replace(/\s+/g, " ").replace(/^ ?(self|cls)(, )?/, "").replace(/,? *$/, "");
                entry.members.push(line(property ? `${member}: ${result}` : `${member}(${memberParameters})${result ? ` -> ${result}` : ""}`, memberDoc));
            }
        }
        entries.push(entry);
    }
    return entries;
}

/** Exported names of a module. */
const exported = (file) => new Set([...source(`python/kinopt/${file}`).split("__all__ = [")[1].split("]")[0].matchAll(/"(\w+)"/g)].map(([, name]) => name));

export function pythonReference() {
    const words = wordsOfRust();
    const text = ["# Python reference", "", "Classes and functions of the package `kinopt`, with their docstrings. Their use is shown on [the package's page](https://github.com/kinopt/kinopt/blob/main/python/README.md).", ""];
    for (const [module, exports, stub, files] of MODULES) {
        const names = exported(exports);
        const all = [...ofStub(stub, words), ...files.flatMap(ofFile)].filter(({ name }) => names.has(name));
        text.push(`## ${module}`, "");
        for (const entry of all.sort((a, b) => (a.name < b.name ? -1 : 1))) {
            text.push(`### ${module}.${entry.name}`, "");
            if (entry.signature) text.push(...block(entry.signature));
            text.push(plain(entry.doc), "", ...entry.members, "");
        }
    }
    return text.join("\n");
}
