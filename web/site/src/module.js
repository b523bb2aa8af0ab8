// The library's module, fetched once for all workers. Its file is compressed, because not every server compresses.

const FILE = "kinopt.wasm.packed";
const GZIP = [0x1f, 0x8b];
const UNFETCHED = "The library cannot be fetched. Check that the server is running, and reload the page.";

/** The compiled module; `report` receives the fraction that is fetched. */
export async function fetchedModule(report = () => {}) {
    const response = await fetch(new URL(`./${FILE}`, import.meta.url)).catch(() => undefined);
    if (!response?.ok) throw new Error(UNFETCHED);
    const total = Number(response.headers.get("content-length"));
    let done = 0;
    const counter = new TransformStream({
        transform(bytes, out) {
            done += bytes.length;
            if (total > 0) report(Math.min(1, done / total));
            out.enqueue(bytes);
        },
    });
    const stream = await unpacked(response.body.pipeThrough(counter));
    return WebAssembly.compileStreaming(new Response(stream, { headers: { "content-type": "application/wasm" } }));
}

/** The content of a compressed stream; a browser decompresses it already if the server declares the compression. */
async function unpacked(stream) {
    const [head, all] = stream.tee();
    const reader = head.getReader();
    const { value } = await reader.read();
    reader.cancel();
    const isPacked = GZIP.every((byte, k) => value?.[k] === byte);
    return isPacked ? all.pipeThrough(new DecompressionStream("gzip")) : all;
}
