// Files that are chosen or dropped: their bytes by their names, without folders.

export const extension = (name) => name.slice(name.lastIndexOf(".") + 1).toLowerCase();

/** `{ name: bytes }` of a list of files. */
export async function bytesOf(list) {
    const files = [...list].map(async (file) => [file.name, new Uint8Array(await file.arrayBuffer())]);
    return Object.fromEntries(await Promise.all(files));
}

/** What is dropped, whole folders too. It must be asked while the drop is told, as what is dropped is forgotten then. */
export async function dropped({ items, files }) {
    const entries = [...items].map((item) => item.webkitGetAsEntry?.());
    if (!entries.some((entry) => entry?.isDirectory)) return [...files];
    const found = await Promise.all(entries.filter(Boolean).map(within));
    return found.flat();
}

async function within(entry) {
    if (entry.isFile) return [await new Promise((resolve, reject) => entry.file(resolve, reject))];
    const reader = entry.createReader();
    const all = [];
    // A reader gives a hundred entries at a time.
    for (;;) {
        const some = await new Promise((resolve, reject) => reader.readEntries(resolve, reject));
        if (some.length === 0) break;
        all.push(...some);
    }
    return (await Promise.all(all.map(within))).flat();
}

const isRobot = (name) => ["urdf", "xml"].includes(extension(name));
const isCapture = (name) => extension(name) === "bvh";
const without = (files, left) => Object.fromEntries(Object.entries(files).filter(([name]) => !left(name)));

/** Files for a movement on a robot, of which only one is new: the other stays. */
export function besideNew(before, files) {
    const names = Object.keys(files);
    if (names.some(isCapture) && !names.some(isRobot)) return { ...without(before, isCapture), ...files };
    if (names.some(isRobot) && !names.some(isCapture)) {
        const captures = Object.entries(before).filter(([name]) => isCapture(name));
        return { ...files, ...Object.fromEntries(captures) };
    }
    return files;
}
