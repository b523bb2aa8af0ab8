// Steps of a dragged body: if its target takes the centre of mass out of the support polygon, the nearer foot steps
// under it.
import { contains, hull, middle } from "./support.js";

/** Lengths relative to the height of the body: miss that starts a step, longest step, shortest step, lift of the foot. */
const [MISS, LONGEST, SHORTEST, LIFT] = [0.03, 0.18, 0.03, 0.06];
/** Frames with a miss before a step, frames of a step, and frames after which a late foot counts as placed. */
const [PATIENCE, STEP_FRAMES, MAX_STEP_FRAMES] = [4, 16, 40];
/** Distance from its place under the body, relative to its height, at which a foot follows the other. */
const TRAILING = 0.12;

/** Smallest distance of two feet across, relative to that at rest: legs do not cross. */
const APART = 0.7;

const minus = ([a, b], [c, d]) => [a - c, b - d];
const plus = ([a, b], [c, d]) => [a + c, b + d];
const shortened = (vector, most) => vector.map((value) => value * Math.min(1, most / Math.hypot(...vector)));

export class Steps {
    #missed = 0;
    /** Feet that may still follow after a step. */
    #trailing = 0;

    /** `height` is that of the body, metres, and `q` its configuration at rest. */
    constructor(support, height, q) {
        this.support = support;
        this.height = height;
        const { centre, corners } = support.at(q);
        /** Places of the feet relative to the centre of mass. */
        this.homes = new Map(support.feet.map((foot) => [foot, minus(middle(corners[foot]), centre)]));
    }

    /** Starts a drag with these feet on the ground, and their placements; `points` are feet that keep positions only. */
    begin(placements, points) {
        this.points = points;
        // A foot in the air lands first.
        if (this.swing && placements.has(this.swing.foot)) placements.get(this.swing.foot).set([...this.swing.to, this.swing.ground], 12);
        this.placements = placements;
        this.swing = undefined;
        this.#missed = 0;
        this.#trailing = 0;
    }

    /** Targets of the feet in the next frame. */
    targets() {
        if (!this.swing) return {};
        const { foot, from, to } = this.swing;
        this.swing.frame += 1;
        const along = Math.min(1, this.swing.frame / STEP_FRAMES);
        const smooth = along * along * (3 - 2 * along);
        const placement = this.placements.get(foot);
        placement[12] = from[0] + smooth * (to[0] - from[0]);
        placement[13] = from[1] + smooth * (to[1] - from[1]);
        placement[14] = this.swing.ground + LIFT * this.height * 4 * along * (1 - along);
        return { [foot]: this.points.has(foot) ? placement.slice(12, 15) : placement };
    }

    /** True while a foot is in the air or will be. */
    get active() {
        return this.swing !== undefined || this.#missed > 0;
    }

    /** Follows a frame: `miss` is the vector from the dragged frame to its target, and `rests` is true at rest. */
    follow(q, miss, rests) {
        const state = this.support.at(q);
        if (this.swing) {
            const error = Math.hypot(...minus(this.swing.landing, middle(state.corners[this.swing.foot])));
            const lands = this.swing.frame >= STEP_FRAMES && error < 0.01 * this.height;
            if (lands || this.swing.frame >= MAX_STEP_FRAMES) this.swing = undefined;
            return;
        }
        const wanted = plus(state.centre, shortened(miss, LONGEST * this.height));
        const onGround = Object.values(state.corners).flat();
        const leaves = Math.hypot(...miss) > MISS * this.height && (rests || !contains(hull(onGround), wanted));
        this.#missed = leaves ? this.#missed + 1 : 0;
        if (this.#missed >= PATIENCE) this.#step(state, wanted);
        else if (rests && this.#trailing > 0 && !leaves) this.#close(state);
    }

    /** Moves the foot that is nearest to the wanted centre of mass and not yet below it. */
    #step({ corners }, wanted) {
        this.#missed = 0;
        const at = new Map(this.support.feet.map((foot) => [foot, middle(corners[foot])]));
        const away = (foot) => Math.hypot(...minus(at.get(foot), wanted));
        const nearest = [...this.placements.keys()].sort((a, b) => away(a) - away(b));
        for (const foot of nearest) {
            const home = plus(wanted, this.homes.get(foot));
            // The legs reach as far as the other feet allow.
            const others = nearest.filter((other) => other !== foot);
            const body = middle(others.map((other) => minus(at.get(other), this.homes.get(other))));
            const shift = shortened(minus(minus(home, this.homes.get(foot)), body), LONGEST * this.height);
            const landing = this.#apart(foot, plus(plus(body, shift), this.homes.get(foot)), corners);
            if (Math.hypot(...minus(landing, at.get(foot))) > SHORTEST * this.height) {
                this.#trailing = others.length;
                return this.#swing(foot, at.get(foot), landing);
            }
        }
        return undefined;
    }

    /** Moves the foot that trails the body farthest to its place. */
    #close({ centre, corners }) {
        const trailing = [...this.placements.keys()].map((foot) => [foot, minus(plus(centre, this.homes.get(foot)), middle(corners[foot]))]);
        const [foot, gap] = trailing.sort(([, a], [, b]) => Math.hypot(...b) - Math.hypot(...a))[0];
        const at = middle(corners[foot]);
        this.#trailing -= 1;
        if (Math.hypot(...gap) > TRAILING * this.height) this.#swing(foot, at, this.#apart(foot, plus(at, gap), corners));
    }

    /** A landing on the foot's own side of the other feet. */
    #apart(foot, landing, corners) {
        return [...this.placements.keys()].filter((other) => other !== foot).reduce((place, other) => {
            const across = minus(this.homes.get(foot), this.homes.get(other));
            const width = Math.hypot(...across);
            const [x, y] = minus(place, middle(corners[other]));
            const lack = APART * width - (x * across[0] + y * across[1]) / width;
            return lack > 0 ? plus(place, across.map((value) => (value * lack) / width)) : place;
        }, landing);
    }

    #swing(foot, at, landing) {
        const placement = this.placements.get(foot);
        const from = [placement[12], placement[13]];
        this.swing = { foot, from, to: plus(from, minus(landing, at)), landing, ground: placement[14], frame: 0 };
    }
}
