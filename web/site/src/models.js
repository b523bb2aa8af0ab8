// Models of the page.

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

async function fetched(...names) {
    const files = names.map(async (name) => {
        const response = await fetch(new URL(`./models/${name}`, import.meta.url)).catch(() => {
            throw new Error(`${name} cannot be fetched: check that the server is running`);
        });
        if (!response.ok) throw new Error(`${name}: ${response.status}`);
        return [name, new Uint8Array(await response.arrayBuffer())];
    });
    return Object.fromEntries(await Promise.all(files));
}

export const MODELS = {
    humanoid: async () => ({ files: await fetched("humanoid.json", "humanoid.ply", "humanoid.dmat") }),
    capture: async () => ({ files: await fetched("steps.bvh", "aldebaran_nao.urdf") }),
    panda: async () => ({ files: await fetched("franka_panda.urdf"), world: BOXES, floor: FLOOR, start: START_ANGLES }),
};
