// Compressed files of the site, because not every server compresses.

const GZIP = [0x1f, 0x8b];

/** Suffix of compressed files: no server knows it, so none declares an encoding. */
const SUFFIX = ".packed";

/** Content of a file of the site as a stream; `report` receives the fraction that is fetched. */
export async function fetchedStream(name, report = () => {}) {
    const response = await fetch(new URL(`./${name}${SUFFIX}`, import.meta.url)).catch(() => {
        throw new Error(`${name} cannot be fetched: check that the server is running`);
    });
    if (!response.ok) throw new Error(`${name}: ${response.status}`);
    const total = Number(response.headers.get("content-length"));
    let done = 0;
    const counter = new TransformStream({
        transform(bytes, out) {
            done += bytes.length;
            if (total > 0) report(Math.min(1, done / total));
            out.enqueue(bytes);
        },
    });
    return unpacked(response.body.pipeThrough(counter));
}

/** The content of a compressed stream; a stream without compression is returned as it is. */
async function unpacked(stream) {
    const [head, all] = stream.tee();
    const reader = head.getReader();
    const { value } = await reader.read();
    reader.cancel();
    const isPacked = GZIP.every((byte, k) => value?.[k] === byte);
    return isPacked ? all.pipeThrough(new DecompressionStream("gzip")) : all;
}
