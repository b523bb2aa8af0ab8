// What a robot looks like: its meshes where their files are there, else the primitive shapes that it has.

const DRAWN = ["stl", "dae", "obj"];

/** The name of a file without its folders. */
const bare = (file) => file.split(/[\\/]/).pop();

/**
 * The shapes of each frame of a robot's model; notes of what is missing, and sticks that are drawn for it; of plain shapes what may
 * leave gaps; `names` are those of the files that are there.
 */
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
    if (shapes.every((own) => own.length === 0)) return { shapes, notes: ["It has no shapes, so sticks stand for its links."], sticks: parents(robot) };
    return { shapes, notes: [], gaps: shapes.flat().some(({ kind }) => kind === "mesh") ? undefined : tree(robot) };
}

/** The number of the frame that each one hangs on, -1 where none does: the first of those to which one joint less leads. */
const parents = (robot) => tree(robot).parents;

/** These, and the number of the first frame of the body that each one is of: to which the same joints lead. */
function tree(robot) {
    const names = robot.model.frameNames;
    const chains = names.map((name) => robot.chain(names[0], name));
    const known = new Map(chains.map((chain, k) => [chain.join(), k]).reverse());
    const bodies = chains.map((chain) => known.get(chain.join()));
    return { bodies, parents: chains.map((chain) => (chain.length === 0 ? -1 : known.get(chain.slice(0, -1).join()) ?? -1)) };
}
