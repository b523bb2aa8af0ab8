// Puts the package together in dist/, beside what wasm-bindgen wrote there: what is exported, its types, a robot to begin with.
import { copyFileSync, cpSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { brotliCompressSync, gzipSync } from "node:zlib";

const here = (path) => new URL(path, import.meta.url);
const text = (path) => readFileSync(here(path), "utf8");
const write = (path, lines) => writeFileSync(here(`dist/${path}`), `${lines.join("\n")}\n`);
const names = (path, pattern) => [...text(path).matchAll(pattern)].map(([, name]) => name);

cpSync(here("js/"), here("dist/"), { recursive: true });
for (const license of ["LICENSE-APACHE", "LICENSE-MIT"]) copyFileSync(here(`../${license}`), here(license));
rmSync(here("dist/kinopt_bg.wasm.d.ts"));

// All but what makes the module ready.
const classes = names("dist/kinopt.js", /^export (?:class|function) (\w+)/gm).join(", ");
const types = names("dist/kinopt.d.ts", /^export (?:interface|type) (\w+)/gm).filter((name) => !/^(Sync)?Init/.test(name)).join(", ");
const own = ['export { placement } from "./placement.js";', 'export * as tasks from "./tasks.js";'];
write("all.js", [`export { ${classes} } from "./kinopt.js";`, ...own]);
write("index.d.ts", [`export { ${classes} } from "./kinopt.js";`, `export type { ${types} } from "./kinopt.js";`, ...own]);
write("bare.d.ts", ['export { default as init, initSync } from "./kinopt.js";', 'export * from "./index.js";']);
// `using` is newer than the settings of most projects.
write("kinopt.d.ts", ['/// <reference lib="esnext.disposable" />', text("dist/kinopt.d.ts")]);

mkdirSync(here("dist/models"));
write("models/franka_panda.js", [`export default ${JSON.stringify(text("../models/franka_panda.urdf"))};`]);
write("models/franka_panda.d.ts", ["declare const urdf: string;", "export default urdf;"]);

const module = readFileSync(here("dist/kinopt_bg.wasm"));
const kilobytes = (bytes) => `${(bytes.length / 1e3).toFixed(0)} kB`;
const [zipped, brotli] = [gzipSync(module, { level: 9 }), brotliCompressSync(module)].map(kilobytes);
console.log(`web/dist/kinopt_bg.wasm: ${kilobytes(module)}, ${zipped} by gzip, ${brotli} by brotli`);
