// What a robot looks like: its meshes where their files are there, else the primitive shapes that it has.

const DRAWN = ["stl", "dae", "obj"];

/** The name of a file without its folders. */
const bare = (file) => file.split(/[\\/]/).pop();

/** The shapes of each frame of a robot's model, and notes of what is missing; `names` are those of the files that are there. */
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
    return { shapes, notes: missing.size > 0 ? [note] : [] };
}
