// Ranking of the documentation's search.

/** Terms that users of other tools write, with the terms of these pages. */
const SYNONYMS = {
    ik: ["inverse kinematics"],
    fk: ["forward kinematics"],
    eef: ["tool", "frame", "tip"],
    effector: ["tool", "frame", "tip"],
    seed: ["start"],
    goal: ["target"],
    waypoint: ["path"],
    teleop: ["servo"],
    teleoperation: ["servo"],
    realtime: ["servo"],
    mocap: ["motion capture", "bvh"],
    footskate: ["foot lock", "foot plant"],
    planting: ["foot plant", "planted"],
    nullspace: ["null space", "redundan"],
    humanoid: ["whole bod", "whole-bod"],
    acm: ["allowed collision"],
    obstacle: ["world"],
    timing: ["trajector"],
    toppra: ["trajector"],
    qp: ["bounded", "priority"],
    rigging: ["skeleton", "armature"],
    skinning: ["linear blend", "dual quaternion"],
    lbs: ["linear blend"],
    dqs: ["dual quaternion"],
    glb: ["gltf"],
    jump: ["reconfiguration"],
    flip: ["reconfiguration"],
    gradient: ["derivative"],
    jax: ["derivative"],
    torch: ["derivative"],
    wasm: ["web", "javascript"],
    moveit: ["coming from"],
    pink: ["coming from"],
};
/** Weight of a match: whole words count more than parts, headings more than text, synonyms less. */
const WEIGHTS = { heading: 10, name: 6, text: 2, synonym: 0.6 };

/** Lower case, without the underscores in which the languages' names differ: `solve_path` and `solvePath` are one. */
const plain = (text) => text.toLowerCase().replaceAll("_", "");

function preference(address) {
    if (address.includes("guide/")) return 4;
    if (/changelog|decisions\//i.test(address)) return -8;
    return address.includes("internals/") ? -4 : 0;
}

function weight(term, heading, text, names) {
    if (heading.includes(term)) return WEIGHTS.heading;
    if (names.has(term)) return WEIGHTS.name;
    return text.includes(term) ? WEIGHTS.text : 0;
}

/** Sections with the texts that a query is compared with. A section is [page title, heading, address, text]. */
export function indexed(sections) {
    return sections.map(([page, heading, address, text]) => {
        const below = plain(text);
        const names = new Set(below.match(/[\p{L}\d]+/gu));
        return { page, heading, address, title: plain(heading), above: plain(`${heading} ${page}`), below, names };
    });
}

/** Synonyms of a word, also of its plural. */
const synonyms = (word) => SYNONYMS[word] ?? SYNONYMS[word.replace(/s$/, "")] ?? [];

/**
 * Indexed sections that contain all words of a query, best first.
 *
 * Each word may be replaced by a synonym. Guides come before references, and both before the changelog and decision
 * records.
 */
export function ranked(index, query) {
    const words = query.split(/\s+/).filter(Boolean).map(plain);
    if (words.length === 0) return [];
    const found = [];
    for (const { page, heading, address, title, above, below, names } of index) {
        const weights = words.map((word) => {
            const others = synonyms(word).map((term) => WEIGHTS.synonym * weight(term, above, below, names));
            return Math.max(weight(word, above, below, names), ...others);
        });
        if (weights.includes(0)) continue;
        const exact = title === words.join(" ") ? 5 : 0;
        const score = weights.reduce((sum, term) => sum + term, exact + preference(address));
        found.push({ page, heading, address, score });
    }
    return found.sort((a, b) => b.score - a.score);
}
