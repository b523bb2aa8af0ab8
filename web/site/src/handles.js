// Handles: frames of a model that can be dragged, and their positions.
import { ForwardKinematics } from "kinopt";

export class Handles {
    /** `frames` are frame names by handle. */
    constructor(model, frames) {
        this.names = Object.keys(frames);
        this.frames = frames;
        this.kinematics = new ForwardKinematics(model, Object.values(frames));
    }

    /** Positions of the handles, three numbers each. */
    places(q) {
        const placements = this.kinematics.place(q);
        const positions = new Float32Array(3 * this.names.length);
        for (let k = 0; k < this.names.length; k += 1) positions.set(placements.subarray(16 * k + 12, 16 * k + 15), 3 * k);
        return positions;
    }

    /** Position of one handle, in double precision. */
    place(q, name) {
        const k = this.names.indexOf(name);
        return Array.from(this.kinematics.place(q).subarray(16 * k + 12, 16 * k + 15));
    }
}

/** Joint names of a bone's three angles, which users do not know. */
const PART = /`([^`]+)\/(?:twist|bend)\d*`/g;
/** Frame names of the tips of bones, which have the names of the bones on the page. */
const TIP = /\b(\w+)\/tip\b/g;

/**
 * The part of an explanation that a user can act on: the distance out of reach, else the missed tasks and the reason.
 */
function shortly(solution) {
    const [, ...all] = solution.explain().split("\n").map((line) => line.trim());
    // The page offers no other starts.
    const relevantLines = all.filter((line) => !/attempt|More time/.test(line));
    // Users know pinned frames, but no numbers of priority levels.
    const lines = relevantLines.map((line) => (/^Levels? \d/.test(line) ? "Pinned joints or the balance prevent it." : line.replace(PART, "`$1`").replace(TIP, "$1")));
    const unreachableLines = solution.isOutOfReach ? lines.filter((line) => line.startsWith("Out of reach")) : [];
    return [...unreachableLines, ...lines].slice(0, unreachableLines.length || 3).join(" ");
}

/** Texts of a solution for the page; an invisible miss needs none. */
export const solutionTexts = (solution, reach) => ({
    reached: solution.reached,
    limits: solution.activeLimits.map(({ joint }) => joint),
    words: solution.reached || solution.positionError < 0.005 * reach ? "" : shortly(solution),
});
