// The library's module, fetched once for all workers.
import { fetchedStream } from "./packed.js";

/** The compiled module; `report` receives the fraction that is fetched. */
export async function fetchedModule(report) {
    const stream = await fetchedStream("kinopt.wasm", report);
    return WebAssembly.compileStreaming(new Response(stream, { headers: { "content-type": "application/wasm" } }));
}
