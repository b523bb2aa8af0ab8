// Chosen or dropped files: their bytes by name, without folders.

export const extension = (name) => name.slice(name.lastIndexOf(".") + 1).toLowerCase();

/** `{ name: bytes }` of a list of files. */
export async function bytesOf(list) {
    const files = [...list].map(async (file) => [file.name, new Uint8Array(await file.arrayBuffer())]);
    return Object.fromEntries(await Promise.all(files));
}

/**
 * Dropped files, including whole folders. Call it during the drop event, because its entries are discarded afterwards.
 */
export async function dropped({ items, files }) {
    const entries = [...items].map((item) => item.webkitGetAsEntry?.());
    if (!entries.some((entry) => entry?.isDirectory)) return [...files];
    const lists = await Promise.all(entries.filter(Boolean).map(within));
    return lists.flat();
}

async function within(entry) {
    if (entry.isFile) return [await new Promise((resolve, reject) => entry.file(resolve, reject))];
    const reader = entry.createReader();
    const all = [];
    // A reader returns at most a hundred entries at a time.
    for (;;) {
        const batch = await new Promise((resolve, reject) => reader.readEntries(resolve, reject));
        if (batch.length === 0) break;
        all.push(...batch);
    }
    return (await Promise.all(all.map(within))).flat();
}

const isRobot = (name) => ["urdf", "xml"].includes(extension(name));
const isCapture = (name) => extension(name) === "bvh";
const without = (files, left) => Object.fromEntries(Object.entries(files).filter(([name]) => !left(name)));

/** Files of a motion on a robot if only one of the two is new: the other one stays. */
export function mergeFiles(previous, files) {
    const names = Object.keys(files);
    if (names.some(isCapture) && !names.some(isRobot)) return { ...without(previous, isCapture), ...files };
    if (names.some(isRobot) && !names.some(isCapture)) {
        const captures = Object.entries(previous).filter(([name]) => isCapture(name));
        return { ...files, ...Object.fromEntries(captures) };
    }
    return files;
}
