// Shapes of a robot: its meshes if their files exist, else its primitive shapes.

const MESH_EXTENSIONS = ["stl", "dae", "obj"];

/** Name of a file without its folders. */
const bare = (file) => file.split(/[\\/]/).pop();

/**
 * Shapes of each frame of a robot's model. Missing meshes give notes, and sticks that replace them; plain shapes may
 * leave gaps. `names` are those of the available files.
 */
export function shapesOf(robot, names) {
    const missing = new Set();
    const drawable = (name) => names.includes(name) && MESH_EXTENSIONS.includes(name.slice(name.lastIndexOf(".") + 1).toLowerCase());
    const shapes = robot.model.frameNames.map((link) => {
        const shown = robot.shapes(link).map((shape) => (shape.file ? { ...shape, file: bare(shape.file) } : shape));
        const meshes = shown.filter(({ kind }) => kind === "mesh");
        const lost = meshes.filter(({ file }) => !drawable(file));
        for (const { file } of lost) missing.add(file);
        if (meshes.length > lost.length) return shown.filter((shape) => !lost.includes(shape));
        // Collision shapes of a robot without meshes, because its visual shapes are mostly thin.
        const plain = (list) => list.filter(({ kind }) => kind !== "mesh");
        const solid = plain(robot.shapes(link, true));
        return solid.length > 0 ? solid : plain(shown);
    });
    const examples = [...missing].slice(0, 3).join(", ");
    const note = `${missing.size} meshes are missing or have an unsupported format: ${examples}${missing.size > 3 ? ", …" : ""}.`;
    if (missing.size > 0) return { shapes, notes: [note], sticks: parents(robot) };
    if (shapes.every((linkShapes) => linkShapes.length === 0)) return { shapes, notes: ["The robot has no shapes: sticks represent its links."], sticks: parents(robot) };
    return { shapes, notes: [], gaps: shapes.flat().some(({ kind }) => kind === "mesh") ? undefined : tree(robot) };
}

/** Index of the parent frame of each frame, or -1: the first frame with one joint fewer in its chain. */
const parents = (robot) => tree(robot).parents;

/** Parents, and for each frame the index of the first frame of its body, which has the same joint chain. */
function tree(robot) {
    const names = robot.model.frameNames;
    const chains = names.map((name) => robot.chain(names[0], name));
    const firstIndex = new Map(chains.map((chain, k) => [chain.join(), k]).reverse());
    const bodies = chains.map((chain) => firstIndex.get(chain.join()));
    return { bodies, parents: chains.map((chain) => (chain.length === 0 ? -1 : firstIndex.get(chain.slice(0, -1).join()) ?? -1)) };
}
