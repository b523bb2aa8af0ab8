// A robot: what is pulled of it follows, around what is in the way where there is a world.
import { Arm, CollisionModel, ForwardKinematics, World } from "kinopt";
import { told } from "./handles.js";
import { shapesOf } from "./robot_shapes.js";

/** More limbs than these make a body, which begins as its file has it; arms begin bent. */
const ARMS = 2;

/** Frames at the ends of limbs, one of each chain of joints that is no part of another; of a robot with a flange that alone. */
function ends(robot, base) {
    if (robot.model.frameNames.includes("flange")) return ["flange"];
    const byChain = new Map();
    for (const tip of robot.tips) {
        const chain = robot.chain(base, tip).join("\n");
        if (chain && !byChain.has(chain)) byChain.set(chain, tip);
    }
    const goesOn = (chain) => [...byChain.keys()].some((other) => other.startsWith(`${chain}\n`));
    const found = [...byChain].filter(([chain]) => !goesOn(chain)).map(([, tip]) => tip);
    // Of what has no joints the library says so.
    return found.length > 0 ? found : robot.tips.slice(0, 1);
}

/** Near the middle of the limits, so that an arm begins bent. */
const bent = ({ lower, upper }) =>
    lower.map((low, k) => (Number.isFinite(low + upper[k]) ? 0.5 * (low + upper[k]) : 0));
const straight = ({ lower, upper }) => lower.map((low, k) => Math.min(Math.max(0, low), upper[k]));

export class ArmSession {
    #arms = new Map();

    constructor(robot, files, { world }) {
        this.drawn = shapesOf(robot, files);
        this.robot = robot;
        this.base = robot.model.frameNames[0];
        this.tips = ends(robot, this.base);
        const names = robot.model.frameNames;
        this.frames = this.tips.map((tip) => names.indexOf(tip));
        this.kinematics = new ForwardKinematics(robot.model);
        this.boxes = world ?? [];
        this.rest();
    }

    /** The arm that ends in `tip`, made when it is first asked for. */
    #arm(tip) {
        if (!this.#arms.has(tip)) this.#arms.set(tip, this.#made(tip));
        return this.#arms.get(tip);
    }

    #made(tip) {
        const { robot, base, boxes } = this;
        // Few joints cannot turn a tool any way.
        const few = robot.chain(base, tip).length < 6;
        const options = few ? { goal: "position" } : {};
        if (boxes.length === 0) return new Arm(robot, base, tip, options);
        const obstacles = new World();
        for (const { name, size, at } of boxes) obstacles.addBox(name, size, at);
        return Arm.keepingClear(robot, base, tip, CollisionModel.ofRobot(robot), obstacles, 0.01, options);
    }

    describe() {
        return {
            kind: "robot",
            up: "z",
            from: [0.55, -1, 0.35],
            handles: this.tips,
            pins: [],
            shapes: this.drawn.shapes,
            sticks: this.drawn.sticks,
            boxes: this.boxes,
            seconds: 0,
            notes: [...this.robot.repairs, ...this.drawn.notes],
        };
    }

    skin() {
        return this.show();
    }

    rest() {
        /** Where each joint of a limb stands: limbs may share some. */
        this.at = new Map();
        this.whole = this.robot.model.neutral();
        const begins = this.tips.length > ARMS ? straight : bent;
        for (const tip of this.tips) {
            const arm = this.#arm(tip);
            this.#stand(arm, begins(arm));
        }
        this.grab(this.tips[0]);
        return this.show();
    }

    /** Takes what a limb's joints are at for where the robot stands. */
    #stand(arm, q) {
        arm.jointNames.forEach((joint, k) => this.at.set(joint, q[k]));
        this.whole = arm.configuration(q, this.whole);
        this.q = q;
    }

    grab(handle) {
        this.arm = this.#arm(handle);
        this.q = Float64Array.from(this.arm.jointNames, (joint) => this.at.get(joint));
        this.follower = this.arm.follower(this.q);
        this.target = this.arm.baseFromTool(this.q);
        return {};
    }

    drag(place) {
        const begun = performance.now();
        this.target.set(place, 12);
        const solution = this.follower.advance(this.target);
        const before = this.q;
        this.#stand(this.arm, solution.q);
        const milliseconds = performance.now() - begun;
        const rests = this.q.every((value, k) => Math.abs(value - before[k]) < 1e-6);
        return { ...this.show(), ...told(solution, this.robot.model.reach), solved: milliseconds, rests };
    }

    show() {
        const links = Float32Array.from(this.kinematics.place(this.whole));
        const places = this.frames.flatMap((frame) => [...links.subarray(16 * frame + 12, 16 * frame + 15)]);
        return { links, places: Float32Array.from(places), posed: 0 };
    }
}
