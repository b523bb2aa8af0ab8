// Assembles a folder of the package, next to the output of wasm-bindgen: exports, types, and an example robot.
// `node web/assemble.js dist/arms` is for the module with arms only, which has no tasks and no drawing.
import { copyFileSync, cpSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { brotliCompressSync, gzipSync } from "node:zlib";

const folder = process.argv[2];
const here = (path) => new URL(path, import.meta.url);
const inside = (path) => here(join(folder, path));
const text = (path) => readFileSync(inside(path), "utf8");
const write = (path, lines) => writeFileSync(inside(path), `${lines.join("\n")}\n`);
const names = (path, pattern) => [...text(path).matchAll(pattern)].map(([, name]) => name);

cpSync(here("js/"), inside(""), { recursive: true });
for (const license of ["LICENSE-APACHE", "LICENSE-MIT"]) copyFileSync(here(`../${license}`), here(license));
rmSync(inside("kinopt_bg.wasm.d.ts"));

// Exports except those that load the module.
const classes = names("kinopt.js", /^export (?:class|function) (\w+)/gm).join(", ");
const types = names("kinopt.d.ts", /^export (?:interface|type) (\w+)/gm).filter((name) => !/^(Sync)?Init/.test(name)).join(", ");
const errors = names("errors.js", /^export class (\w+)/gm).join(", ");
const own = ['export { placement } from "./placement.js";', `export { ${errors} } from "./errors.js";`];
const isWhole = /\bProblem\b/.test(classes);
if (isWhole) own.push('export * as tasks from "./tasks.js";');
else for (const file of ["tasks.js", "tasks.d.ts", "three.js", "three.d.ts"]) rmSync(inside(file));
write("all.js", ['import "./printing.js";', `export { ${classes} } from "./kinopt.js";`, ...own]);
write("index.d.ts", [`export { ${classes} } from "./kinopt.js";`, `export type { ${types} } from "./kinopt.js";`, ...own]);
write("bare.d.ts", ['export { default as init, initSync } from "./kinopt.js";', 'export * from "./index.js";']);
// `using` is newer than the settings of most projects. Types that only browsers and Node define fall back to `never` in
// projects without them.
const known = (path) => path.split(".").reduceRight((inner, name) => `{ ${name}: ${inner} }`, "{ prototype: infer Type }");
const global = (path) => `(typeof globalThis extends ${known(path)} ? Type : never)`;
const everywhere = text("kinopt.d.ts")
    .replace("RequestInfo |", `string | ${global("Request")} |`)
    .replace("URL | Response |", `${global("URL")} | ${global("Response")} |`)
    .replaceAll("BufferSource", "ArrayBufferView | ArrayBuffer")
    .replace(/(?<=[|:<] ?)WebAssembly\.(?:Module|Memory|Table)/g, global);
write("kinopt.d.ts", ['/// <reference lib="esnext.disposable" />', everywhere]);

// Arguments are checked by their documented types.
const CHECKS = { Numbers: "numbers", Placement: "numbers", string: "string", "string[]": "strings", number: "number", "Uint8Array | number[]": "bytes", "readonly Task[]": "array" };
function checks(comment, body) {
    return [...comment.matchAll(/@param \{(.*)\} (\[?)(\w+)/g)].map(([, type, optional, name]) => {
        const own = type.replace(/ \| (null|undefined)/g, "");
        const check = body.includes(`(${name}) >>> 0`) ? "whole" : (CHECKS[own] ?? (classes.split(", ").includes(own) ? "instance" : undefined));
        if (!check) return "";
        const call = `given.${check}(${name}, "${name}"${check === "instance" ? `, ${own}` : ""});\n`;
        return optional || own !== type ? `if (!isLikeNone(${name})) ${call}` : call;
    }).join("");
}
const checked = text("kinopt.js").replace(
    /(^( *)\/\*\*\n(?: +\*.*\n)+?)(\2(?:static |export function )?\w+\(.*\) \{\n)([^]*?^\2\}$)/gm,
    (_, comment, indent, head, body) => comment + head + checks(comment, body) + body,
);
// A failed allocation in the module is a RangeError instead of a trap.
const room = (name, sizeAt) => `const ${name} = given.allocating((...sizes) => wasm.__wbindgen_${name}(...sizes), ${sizeAt});`;
const roomy = checked.replace(/, wasm\.__wbindgen_(malloc|realloc)\b/g, ", $1");
write("kinopt.js", ['import * as given from "./given.js";', room("malloc", 0), room("realloc", 2), roomy]);

if (isWhole) {
    mkdirSync(inside("models"));
    const urdf = readFileSync(here("../models/franka_panda.urdf"), "utf8");
    write("models/franka_panda.js", [`export default ${JSON.stringify(urdf)};`]);
    write("models/franka_panda.d.ts", ["declare const urdf: string;", "export default urdf;"]);
}

const module = readFileSync(inside("kinopt_bg.wasm"));
const kilobytes = (bytes) => `${(bytes.length / 1e3).toFixed(0)} kB`;
const [zipped, brotli] = [gzipSync(module, { level: 9 }), brotliCompressSync(module)].map(kilobytes);
console.log(`web/${folder}/kinopt_bg.wasm: ${kilobytes(module)}, ${zipped} by gzip, ${brotli} by brotli`);
