// Without a module: `init` or `initSync` is called once with one, before anything else.
export { default as init, initSync } from "./kinopt.js";
export * from "./all.js";
