// What a robot looks like: its meshes where their files are there, else the primitive shapes that it has.

const DRAWN = ["stl", "dae", "obj"];

/** The name of a file without its folders. */
const bare = (file) => file.split(/[\\/]/).pop();

/** The shapes of each frame of a robot's model; notes of what is missing, and sticks that are drawn for it; `names` are those of the files that are there. */
export function shapesOf(robot, names) {
    const missing = new Set();
    const drawable = (name) => names.includes(name) && DRAWN.includes(name.slice(name.lastIndexOf(".") + 1).toLowerCase());
    const shapes = robot.model.frameNames.map((link) => {
        const shown = robot.shapes(link).map((shape) => (shape.file ? { ...shape, file: bare(shape.file) } : shape));
        const meshes = shown.filter(({ kind }) => kind === "mesh");
        const lost = meshes.filter(({ file }) => !drawable(file));
        for (const { file } of lost) missing.add(file);
        if (meshes.length > lost.length) return shown.filter((shape) => !lost.includes(shape));
        // Of a robot of plain shapes those that it bumps into things with, as what it shows are mostly lines.
        const plain = (list) => list.filter(({ kind }) => kind !== "mesh");
        const solid = plain(robot.shapes(link, true));
        return solid.length > 0 ? solid : plain(shown);
    });
    const some = [...missing].slice(0, 3).join(", ");
    const note = `${missing.size} meshes were not dropped with it, or are none that can be drawn: ${some}${missing.size > 3 ? ", …" : ""}.`;
    if (missing.size > 0) return { shapes, notes: [note], sticks: parents(robot) };
    const empty = shapes.every((own) => own.length === 0);
    return empty ? { shapes, notes: ["It has no shapes, so sticks stand for its links."], sticks: parents(robot) } : { shapes, notes: [] };
}

/** The number of the frame that each one hangs on, -1 where none does: that to which one joint less leads. */
function parents(robot) {
    const names = robot.model.frameNames;
    const chains = names.map((name) => robot.chain(names[0], name));
    const known = new Map(chains.map((chain, k) => [chain.join(), k]));
    return chains.map((chain) => (chain.length === 0 ? -1 : known.get(chain.slice(0, -1).join()) ?? -1));
}
