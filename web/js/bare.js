// Entry point without a module: call `init` or `initSync` once before any other function.
export { default as init, initSync } from "./kinopt.js";
export * from "./all.js";
