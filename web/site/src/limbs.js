// Handles of a robot: the ends of its limbs and the joints between, and the limbs that are its feet.
import { ForwardKinematics } from "kinopt";

/** Frames nearer to each other than this share one handle, relative to the robot's size. */
const MIN_HANDLE_DISTANCE = 0.05;
/** Feet are nearly level with the lowest end of a limb, and far below the body, relative to the robot's height. */
const [LEVEL_TOLERANCE, MIN_BODY_HEIGHT] = [0.05, 0.25];

/**
 * Frames at the ends of limbs, one for each joint chain that is not part of another. A flange is the only end of its
 * robot.
 */
function ends({ model, tips }, chainOf, linkOf) {
    if (model.frameNames.includes("flange")) return ["flange"];
    const byChain = new Map();
    for (const tip of tips) {
        const chain = chainOf(tip).join("\n");
        if (chain) byChain.set(chain, [...(byChain.get(chain) ?? []), tip]);
    }
    const goesOn = (chain) => [...byChain.keys()].some((other) => other.startsWith(`${chain}\n`));
    // If several tips are on one link, such as toes on a foot, the link is the end of the limb.
    const limbEnds = [...byChain].filter(([chain]) => !goesOn(chain)).map(([, tipsOfChain]) => (tipsOfChain.length > 1 ? linkOf(tipsOfChain[0]) : tipsOfChain[0]));
    // The library reports robots without joints.
    return limbEnds.length > 0 ? limbEnds : tips.slice(0, 1);
}

export class Limbs {
    #chains = new Map();

    constructor(robot) {
        const names = robot.model.frameNames;
        this.base = names[0];
        this.places = new ForwardKinematics(robot.model).place(robot.model.neutral()).slice();
        const positions = new Map(names.map((name, k) => [name, this.places.subarray(16 * k + 12, 16 * k + 15)]));
        const axis = (k) => [...positions.values()].map((position) => position[k]);
        const length = (values) => Math.max(...values) - Math.min(...values);
        this.height = length(axis(2));
        const minDistance = MIN_HANDLE_DISTANCE * Math.hypot(length(axis(0)), length(axis(1)), this.height);
        const distance = (one, other) => Math.hypot(...positions.get(one).map((value, k) => value - positions.get(other)[k]));

        for (const name of names) this.#chains.set(name, robot.chain(this.base, name));
        const rigid = (one, other) => this.chain(one).join() === this.chain(other).join();
        /** Of the frames that are fixed to each other, one with shapes, else the first. */
        const link = (name) => {
            const rigidFrames = names.filter((other) => rigid(name, other));
            return rigidFrames.find((other) => robot.shapes(other).length > 0) ?? rigidFrames[0];
        };
        const tips = ends(robot, (name) => this.chain(name), link);
        /** Ends of limbs first, then the joints between, one at each position. */
        this.handles = [];
        for (const name of new Set([...tips, ...names.map(link)])) {
            const isCovered = this.handles.some((other) => rigid(name, other) || distance(name, other) < minDistance);
            if ((this.chain(name).length > 0 && !isCovered) || name === tips[0]) this.handles.push(name);
        }
        this.tips = this.handles.filter((name) => tips.includes(name));
        const high = (name) => positions.get(name)[2];
        const lowest = Math.min(...this.tips.map(high));
        const low = this.tips.filter((name) => high(name) < lowest + LEVEL_TOLERANCE * this.height);
        /** Feet, for robots with at least two: the lowest ends of limbs, far below the body. */
        const [first, second] = names;
        /** Body that carries the limbs: the file's first frame, or the first moving one below MuJoCo's world. */
        this.body = first === "world" ? second : first;
        const isHigh = this.body !== undefined && high(this.body) > lowest + MIN_BODY_HEIGHT * this.height;
        this.feet = low.length > 1 && isHigh ? low : [];
        // On a free base the body can be dragged too.
        if (this.feet.length > 0 && !this.handles.includes(this.body)) this.handles.push(this.body);
    }

    /** Joints from the base to a frame. */
    chain(name) {
        return this.#chains.get(name);
    }

    /** The handle that shows a joint: of the handles that it moves, the one with the fewest joints. */
    handleOf(joint) {
        const behind = this.handles.filter((name) => this.chain(name).includes(joint));
        const length = (name) => this.chain(name).length;
        return behind.reduce((best, name) => (best === undefined || length(name) < length(best) ? name : best), undefined);
    }
}
