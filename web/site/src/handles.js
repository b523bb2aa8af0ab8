// The places that can be grabbed: frames of a model, and where they stand.
import { ForwardKinematics } from "kinopt";

export class Handles {
    /** `frames` by the handles' names. */
    constructor(model, frames) {
        this.names = Object.keys(frames);
        this.frames = frames;
        this.kinematics = new ForwardKinematics(model, Object.values(frames));
    }

    /** Three numbers a handle. */
    places(q) {
        const placed = this.kinematics.place(q);
        const places = new Float32Array(3 * this.names.length);
        for (let k = 0; k < this.names.length; k += 1) places.set(placed.subarray(16 * k + 12, 16 * k + 15), 3 * k);
        return places;
    }

    /** Where one stands, in double precision. */
    place(q, name) {
        const k = this.names.indexOf(name);
        return Array.from(this.kinematics.place(q).subarray(16 * k + 12, 16 * k + 15));
    }
}

/** A bone turns in three parts, which a hand does not know. */
const PART = /`([^`]+)\/(?:twist|bend)\d*`/g;

/** Of what a solution explains, that which a hand can do something about: how far out of reach it is, else what misses and why. */
function shortly(solution) {
    const [, ...all] = solution.explain().split("\n").map((line) => line.trim());
    // Other starts are nothing that a hand has.
    const heard = all.filter((line) => !/attempt|More time/.test(line));
    // Of strict levels a hand knows what is pinned, and nothing of their numbers.
    const lines = heard.map((line) => (/^Levels? \d/.test(line) ? "What is pinned, and the balance, leave it no more." : line.replace(PART, "`$1`")));
    const far = solution.isOutOfReach ? lines.filter((line) => line.startsWith("Out of reach")) : [];
    return [...far, ...lines].slice(0, far.length || 3).join(" ");
}

/** What a solution says for the page; a miss that nobody sees needs no words. */
export const told = (solution, reach) => ({
    reached: solution.reached,
    limits: solution.activeLimits.map(({ joint }) => joint),
    words: solution.reached || solution.positionError < 0.005 * reach ? "" : shortly(solution),
});
