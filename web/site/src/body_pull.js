// Drag of any frame of a robot: the whole body follows, pinned frames stay, and a robot on its feet keeps its balance.
import { Drag, ForwardKinematics, Problem, tasks } from "kinopt";

/** Margin of collision avoidance, metres. */
export const MARGIN = 0.01;
/** Priority levels: pinned frames and balance have priority over an unreachable target. */
const [PINNED, BALANCE, PULLED] = [0, 1, 2];

export class BodyPull {
    /**
     * `soles` are the contact points of the feet by name, for a robot on its feet. Without masses there is no balance
     * task.
     */
    constructor(robot, { soles = {}, surroundings } = {}) {
        this.model = robot.model;
        this.stands = Object.keys(soles).length > 0;
        this.surroundings = surroundings;
        this.soles = this.stands && this.#weighs(soles) ? soles : {};
    }

    #weighs(soles) {
        try {
            new Problem(this.model, [tasks.supportPolygon([], { on: soles })]).free();
            return true;
        } catch {
            return false;
        }
    }

    /**
     * Continues from `q`. Pinned frames keep their poses; the dragged frame keeps its orientation only if it is pinned.
     */
    grab(handle, pins, q) {
        const frames = [...new Set([...pins, handle])];
        const placed = new ForwardKinematics(this.model, frames).place(q).slice();
        const placements = new Map(frames.map((name, k) => [name, placed.subarray(16 * k, 16 * k + 16)]));
        const others = frames.filter((name) => name !== handle);
        this.handle = handle;
        this.turned = pins.includes(handle) ? placements.get(handle) : undefined;
        const targetOptions = { name: handle, level: PULLED };
        const taskList = [
            ...others.map((name) => tasks.pose(name, placements.get(name), { name, level: PINNED })),
            this.turned ? tasks.pose(handle, this.turned, targetOptions) : tasks.point(handle, placements.get(handle).slice(12, 15), targetOptions),
            tasks.posture(q, { name: "posture", ...(this.stands && { jointWeights: "upright" }) }),
        ];
        const feet = Object.entries(this.soles).filter(([foot]) => others.includes(foot));
        if (feet.length > 0) taskList.push(tasks.supportPolygon([], { on: Object.fromEntries(feet), name: "balance", level: BALANCE }));
        this.dragging?.free();
        this.dragging = new Drag(this.#problem(taskList), q);
    }

    #problem(taskList) {
        const { model, surroundings } = this;
        return surroundings ? Problem.keepingClear(model, taskList, surroundings.shapes, surroundings.world, MARGIN) : new Problem(model, taskList);
    }

    /** One frame: moves the dragged frame to a position. */
    advance(position) {
        this.turned?.set(position, 12);
        const solution = this.dragging.advance({ [this.handle]: this.turned ?? position });
        return { solution, q: solution.q, rests: this.dragging.isAtRest };
    }
}
