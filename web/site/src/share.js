// A state of the page in the fragment of its address: the scene, the configuration and the camera.

/** Numbers as base64 of single-precision floats, without characters that an address escapes. */
function packed(numbers) {
    const bytes = new Uint8Array(Float32Array.from(numbers).buffer);
    return btoa(String.fromCharCode(...bytes)).replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "");
}

function unpacked(text) {
    const characters = atob(text.replaceAll("-", "+").replaceAll("_", "/"));
    const bytes = Uint8Array.from(characters, (character) => character.charCodeAt(0));
    return [...new Float32Array(bytes.buffer)];
}

/** Fragment of an address for a state. */
export function fragment({ scene, q, view }) {
    const parameters = new URLSearchParams({ scene });
    if (q) parameters.set("q", packed(q));
    if (view) parameters.set("view", packed(view));
    return `#${parameters}`;
}

/** State in a fragment; undefined if it has no scene, or numbers that are damaged. */
export function stateOf(text) {
    const parameters = new URLSearchParams(text.replace(/^#/, ""));
    const scene = parameters.get("scene");
    if (!scene) return undefined;
    try {
        const [q, view] = ["q", "view"].map((name) => (parameters.has(name) ? unpacked(parameters.get(name)) : undefined));
        const isValid = [q, view].every((numbers) => numbers === undefined || numbers.every(Number.isFinite));
        return isValid && (!view || view.length === 6) ? { scene, q, view } : { scene };
    } catch {
        return { scene };
    }
}
