// In Node the module is read from the folder of this file.
import { readFileSync } from "node:fs";
import { initSync } from "./kinopt.js";

initSync({ module: readFileSync(new URL("./kinopt_bg.wasm", import.meta.url)) });

export * from "./all.js";
