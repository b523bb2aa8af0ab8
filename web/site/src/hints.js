// Hints: actions for the opened model, and files that can be dropped.

const DROP = "Drop your own robot (.urdf, .xml, meshes), character (.glb, .gltf, .bvh) or rig here.";
const HINTS = {
    character: ["Grab any joint and pull, while its clip plays too. Blue is pinned, red is at a limit.", DROP],
    clip: ["The clip plays: grab any joint and pull, and pin it there if you like. Pause, then pull, and the pins hold again.", DROP],
    robot: ["Grab its tool or any joint and pull; a pinned tool stays. Red is at a limit.", DROP],
    body: ["Grab any joint and pull. Blue is pinned, red is at a limit.", DROP],
    movement: ["A robot follows a captured person, live.", "Drop a .bvh for it to follow, or another robot's .urdf."],
};

/** Hints for the opened model, if any: possible actions, and files that can be dropped. */
export function hints({ kind, pins = [] } = {}, plays) {
    const what = { character: plays ? "clip" : kind, robot: pins.length > 0 ? "body" : kind }[kind] ?? kind;
    return HINTS[what] ?? ["", ""];
}
