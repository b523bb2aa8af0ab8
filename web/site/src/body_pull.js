// Drag of any frame of a body: the whole body follows, pinned frames stay, and a body on its feet keeps its balance.
import { Drag, ForwardKinematics, Problem, tasks } from "kinopt";
import { Steps } from "./steps.js";
import { Support, hull } from "./support.js";

/** Margin of collision avoidance, metres. */
export const MARGIN = 0.01;
/** Priority levels: pinned frames and balance have priority over an unreachable target. */
const [PINNED, BALANCE, PULLED] = [0, 1, 2];
const UP = [0, 0, 1];
/** Task that keeps the body under the pointer, across the line of sight. */
const SIDE_TASK = "sideways";
/** Displacement of a joint in a frame, radians or metres, below which a body is still, and frames until it rests. */
const [STILL, STILL_FRAMES] = [1e-4, 8];
/** Distance of the centre of mass from the edges of the support polygon, relative to the height of the body. */
const BALANCE_MARGIN = 0.01;

export class BodyPull {
    /**
     * `soles` are the contact points of the feet by frame, `masses` those of tasks, and `height` that of the body in
     * metres. `trunk` is the frame that carries the limbs. Without masses there is no balance task. `frames` are the frames of handles with other names.
     */
    constructor(model, { soles = {}, masses, height, trunk, surroundings, frames = {} }) {
        this.model = model;
        this.surroundings = surroundings;
        this.frames = frames;
        this.height = height;
        this.trunk = trunk;
        this.stands = Object.keys(soles).length > 0;
        if (this.stands && masses) this.support = new Support(model, soles, masses);
    }

    /** Remembers the stance at `q`, to which steps return. */
    stand(q) {
        if (this.support) this.steps = new Steps(this.support, this.height, q);
    }

    /** Centre of mass on the ground and support polygon at a configuration, three numbers a point. */
    balance(q) {
        if (!this.support) return {};
        const { centre, corners } = this.support.at(q);
        const all = Object.values(corners).flat();
        const ground = Math.min(...all.map(([, , z]) => z));
        const polygon = hull(all).flatMap(([x, y]) => [x, y, ground]);
        return { centre: Float32Array.of(...centre, ground), polygon: Float32Array.from(polygon) };
    }

    #frame(handle) {
        return this.frames[handle] ?? handle;
    }

    /** Placements of frames by name at a configuration. */
    #placements(names, q) {
        const placed = new ForwardKinematics(this.model, names).place(q).slice();
        return new Map(names.map((name, k) => [name, placed.subarray(16 * k, 16 * k + 16)]));
    }

    /**
     * Continues from `q`. Pinned frames keep their poses, or their positions if `free` contains them. The dragged frame
     * keeps its orientation only if it is pinned. `eye` is the position of the camera.
     */
    grab(handle, pins, q, { free = new Set(), eye } = {}) {
        const pulled = this.#frame(handle);
        const others = [...new Set(pins.map((pin) => this.#frame(pin)))].filter((name) => name !== pulled);
        const placements = this.#placements([...others, pulled], q);
        const oriented = (name) => !free.has(name);
        const at = (name) => placements.get(name).slice(12, 15);
        this.pulled = pulled;
        this.last = undefined;
        this.turned = pins.includes(handle) && oriented(pulled) ? placements.get(pulled) : undefined;
        // The body itself moves in depth as its legs need.
        this.side = this.support && this.trunk === pulled && eye ? sideways(eye, at(pulled)) : undefined;
        const pinned = (name, options) => (oriented(name) ? tasks.pose(name, placements.get(name), options) : tasks.point(name, at(name), options));
        const taskList = [
            ...others.map((name) => pinned(name, { name, level: PINNED })),
            ...this.#pull(pulled, at(pulled)),
            tasks.posture(q, { name: "posture", ...(this.stands && { jointWeights: "upright" }) }),
        ];
        const feet = (this.support?.feet ?? []).filter((foot) => others.includes(foot));
        if (feet.length > 0) taskList.push(this.#balance(feet));
        // Feet step only if all of them are on the ground.
        this.walks = feet.length > 1 && feet.length === this.support.feet.length;
        if (this.walks) this.steps.begin(new Map(feet.map((foot) => [foot, placements.get(foot)])), free);
        this.kinematics = new ForwardKinematics(this.model, [pulled]);
        this.dragging?.free();
        this.dragging = new Drag(this.#problem(taskList), q);
    }

    #pull(name, at) {
        const options = { name, level: PULLED };
        if (this.turned) return [tasks.pose(name, this.turned, options)];
        if (!this.side) return [tasks.point(name, at, options)];
        return [tasks.plane(name, at, UP, options), tasks.plane(name, at, this.side, { name: SIDE_TASK, level: PULLED })];
    }

    #targets(position) {
        if (!this.side) return { [this.pulled]: this.turned ?? position };
        return { [this.pulled]: [...position, ...UP], [SIDE_TASK]: [...position, ...this.side] };
    }

    #balance(feet) {
        const { masses, soles } = this.support;
        const on = Object.fromEntries(feet.map((foot) => [foot, soles[foot]]));
        return tasks.supportPolygon([], { on, masses, margin: BALANCE_MARGIN * this.height, name: "balance", level: BALANCE });
    }

    #problem(taskList) {
        const { model, surroundings } = this;
        return surroundings ? Problem.keepingClear(model, taskList, surroundings.shapes, surroundings.world, MARGIN) : new Problem(model, taskList);
    }

    /** One frame: moves the dragged frame to a position. */
    advance(position) {
        this.turned?.set(position, 12);
        const feet = this.walks ? this.steps.targets() : {};
        const solution = this.dragging.advance({ ...this.#targets(position), ...feet });
        const { q } = solution;
        const rests = this.dragging.isAtRest || this.#isStill(q);
        if (!this.walks) return { solution, q, rests };
        this.steps.follow(q, this.#miss(this.kinematics.place(q).slice(12, 15), position), rests);
        return { solution, q, rests: rests && !this.steps.active };
    }

    /** True if the body has not moved for some frames: against limits, frames may alternate between near solutions. */
    #isStill(q) {
        const moved = this.last === undefined || q.some((value, k) => Math.abs(value - this.last[k]) > STILL);
        this.last = q;
        this.stillFrames = moved ? 0 : this.stillFrames + 1;
        return this.stillFrames >= STILL_FRAMES;
    }

    /** Vector from the dragged frame to its target, seen from above. */
    #miss(at, position) {
        const miss = [position[0] - at[0], position[1] - at[1]];
        if (!this.side) return miss;
        const along = miss[0] * this.side[0] + miss[1] * this.side[1];
        return [along * this.side[0], along * this.side[1]];
    }
}

/** Horizontal direction across the line of sight. */
function sideways(eye, at) {
    const [x, y] = [at[0] - eye[0], at[1] - eye[1]];
    const length = Math.hypot(x, y) || 1;
    return [-y / length, x / length, 0];
}
