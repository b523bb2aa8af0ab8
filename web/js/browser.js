// In browsers and their workers the module is fetched from the folder of this file.
import init from "./kinopt.js";

await init({ module_or_path: new URL("./kinopt_bg.wasm", import.meta.url) });

export * from "./all.js";
