// Scenes of the page: their models, and their motion until somebody grabs.
import { fetchedStream } from "./packed.js";

/** Boxes around a Panda: full lengths and positions, metres. */
const BOXES = [
    { name: "table", size: [0.5, 1.0, 0.04], at: [0.55, 0, 0.12] },
    { name: "crate", size: [0.16, 0.16, 0.3], at: [0.5, -0.3, 0.29] },
    { name: "shelf", size: [0.3, 0.3, 0.03], at: [0.55, 0.35, 0.6] },
];

/** Height of the ground, metres. The base also keeps the margin (`MARGIN`, 1 cm) from it. */
const FLOOR = -0.011;

/**
 * Start configuration of the Panda, radians: its shoulder is bent too, so that its elbow swings while the tool stays.
 */
const START_ANGLES = [0, -0.4, 0, -2, 0, 1.6, 0.8];

/** Arms of the NAO at its sides, radians. */
const NAO_ARMS = {
    left_shoulder_pitch: 1.35, left_shoulder_roll: 0.2, left_elbow_roll: -0.6, right_shoulder_pitch: 1.35, right_shoulder_roll: -0.2, right_elbow_roll: 0.6,
};

/** Largest upward bend of an ankle under load, degrees, as in `models/humanoid/cones.json`. */
const LOADED_ANKLE = 35;

async function fetched(...names) {
    const files = names.map(async (name) => {
        const stream = await fetchedStream(`models/${name}`);
        return [name, new Uint8Array(await new Response(stream).arrayBuffer())];
    });
    return Object.fromEntries(await Promise.all(files));
}

/** The humanoid with the ankles of a standing figure. */
export function underLoad(files) {
    const rig = JSON.parse(new TextDecoder().decode(files["humanoid.json"]));
    for (const bone of rig.bones) if (/_foot$/.test(bone.name)) bone.xzx_max[1] = LOADED_ANKLE;
    return { ...files, "humanoid.json": new TextEncoder().encode(JSON.stringify(rig)) };
}

const humanoid = async () => ({ files: underLoad(await fetched("humanoid.json", "humanoid.ply", "humanoid.dmat")) });

/** A path that goes away by some metres and comes back. */
const there = (x, y, z) => (along) => [x, y, z].map((value) => 0.5 * value * (1 - Math.cos(2 * Math.PI * along)));
/** A circle through its start, with two diameters in metres. */
const around = (one, other) => (along) => {
    const [sine, cosine] = [Math.sin(2 * Math.PI * along), Math.cos(2 * Math.PI * along)];
    return one.map((value, k) => 0.5 * (value * (1 - cosine) + other[k] * sine));
};

/**
 * Each scene has a name, the request that opens it, a guide, and acts: handles that follow paths, offsets from their
 * position in metres, until somebody grabs.
 */
export const SCENES = {
    humanoid: {
        title: "Character",
        guide: "docs/guide/dragging.html",
        open: humanoid,
        acts: [
            { handle: "pelvis", seconds: 5, path: there(0, 0, -0.28) },
            { handle: "left_hand", seconds: 5, path: around([0.25, -0.15, 0.7], [0.25, 0, 0]) },
            { handle: "pelvis", seconds: 4, path: around([0, 0, -0.1], [0, 0.24, 0]) },
            { handle: "right_hand", seconds: 5, path: there(0.5, 0.3, 0.25) },
        ],
    },
    nao: {
        title: "Humanoid robot",
        guide: "docs/guide/balance.html",
        open: async () => ({ files: await fetched("aldebaran_nao.urdf"), pose: NAO_ARMS }),
        acts: [
            { handle: "torso", seconds: 5, path: there(0, 0, -0.09) },
            { handle: "left_hand", seconds: 5, path: there(0.03, 0.04, 0.2) },
            { handle: "torso", seconds: 5, path: around([0, 0, -0.04], [0, 0.07, 0]) },
        ],
    },
    quadruped: {
        title: "Quadruped",
        guide: "docs/guide/whole-bodies.html",
        open: async () => ({ files: await fetched("quadruped.urdf") }),
        acts: [
            { handle: "body", seconds: 4, path: there(0, 0, -0.1) },
            { handle: "body", seconds: 4, path: around([0, 0, -0.04], [0, 0.08, 0]) },
            { handle: "front_left_foot", seconds: 4, path: there(0.06, 0.02, 0.12) },
            { handle: "head", seconds: 4, path: there(0.03, 0.1, -0.08) },
        ],
    },
    panda: {
        title: "Arm",
        guide: "docs/guide/collision-avoidance.html",
        open: async () => ({ files: await fetched("franka_panda.urdf"), world: BOXES, floor: FLOOR, start: START_ANGLES }),
        acts: [
            { handle: "flange", seconds: 5, path: there(0.1, 0.1, -0.24) },
            { handle: "flange", seconds: 4, path: there(-0.06, -0.3, 0.05) },
            { handle: "flange", seconds: 5, path: there(0, 0.2, 0.22) },
        ],
    },
    clip: {
        title: "Clip",
        guide: "docs/guide/clip-ik.html",
        open: humanoid,
        plays: true,
        acts: [{ handle: "left_hand", seconds: 5, path: there(0.3, -0.2, 0.3) }],
    },
    capture: {
        title: "Capture",
        guide: "docs/guide/retargeting.html",
        open: async () => ({ files: await fetched("steps.bvh", "aldebaran_nao.urdf") }),
        plays: true,
    },
};
