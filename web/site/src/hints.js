// Hints: actions for the opened model, and files that can be dropped.

const DROP = "Drop your own robot (.urdf, .xml, meshes), character (.glb, .gltf, .bvh) or rig here.";
const HINTS = {
    character: ["Drag any joint, also while the clip plays. Blue joints are pinned, red joints are at a limit.", DROP],
    clip: ["The clip plays: drag any joint, and pin it there. Pause to drag with the earlier pins.", DROP],
    robot: ["Drag the tool or any joint; a pinned tool stays. Red joints are at a limit.", DROP],
    body: ["Drag any joint. Blue joints are pinned, red joints are at a limit.", DROP],
    movement: ["A robot follows a captured subject, live.", "Drop a .bvh file for it to follow, or the .urdf of another robot."],
};

/** Hints for the opened model, if any: possible actions, and files that can be dropped. */
export function hints({ kind, pins = [] } = {}, plays) {
    const what = { character: plays ? "clip" : kind, robot: pins.length > 0 ? "body" : kind }[kind] ?? kind;
    return HINTS[what] ?? ["", ""];
}
