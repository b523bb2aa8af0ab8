// A robot: its tool follows, around what is in the way where there is a world.
import { Arm, CollisionModel, ForwardKinematics, World } from "kinopt";
import { told } from "./handles.js";
import { shapesOf } from "./robot_shapes.js";

/** The tip at the end of the most joints. */
function longest(robot, base) {
    const tips = robot.tips.map((tip) => [robot.chain(base, tip).length, tip]);
    return tips.reduce((most, own) => (own[0] > most[0] ? own : most))[1];
}

/** Near the middle of the limits, so that an arm begins bent. */
const bent = ({ lower, upper }) =>
    lower.map((low, k) => (Number.isFinite(low + upper[k]) ? 0.5 * (low + upper[k]) : 0));

export class ArmSession {
    constructor(robot, names, { world }) {
        this.drawn = shapesOf(robot, names);
        this.robot = robot;
        this.base = robot.model.frameNames[0];
        this.tip = robot.model.frameNames.includes("flange") ? "flange" : longest(robot, this.base);
        this.kinematics = new ForwardKinematics(robot.model);
        this.boxes = world ?? [];
        // Few joints cannot turn a tool any way.
        const few = robot.chain(this.base, this.tip).length < 6;
        const options = few ? { goal: "position" } : {};
        if (this.boxes.length > 0) {
            const obstacles = new World();
            for (const { name, size, at } of this.boxes) obstacles.addBox(name, size, at);
            const shapes = CollisionModel.ofRobot(robot);
            this.arm = Arm.keepingClear(robot, this.base, this.tip, shapes, obstacles, 0.01, options);
        } else {
            this.arm = new Arm(robot, this.base, this.tip, options);
        }
        this.rest();
    }

    describe() {
        return {
            kind: "robot",
            up: "z",
            from: [0.55, -1, 0.35],
            handles: [this.tip],
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
        this.q = bent(this.arm);
        this.follower = this.arm.follower(this.q);
        this.target = this.arm.baseFromTool(this.q);
        return this.show();
    }

    grab() {
        this.target = this.arm.baseFromTool(this.q);
        return {};
    }

    drag(place) {
        const begun = performance.now();
        this.target.set(place, 12);
        const solution = this.follower.advance(this.target);
        const before = this.q;
        this.q = solution.q;
        const milliseconds = performance.now() - begun;
        const rests = this.q.every((value, k) => Math.abs(value - before[k]) < 1e-6);
        return { ...this.show(), ...told(solution, this.robot.model.reach), solved: milliseconds, rests };
    }

    show() {
        const whole = this.arm.configuration(this.q, this.robot.model.neutral());
        const links = Float32Array.from(this.kinematics.place(whole));
        const tool = this.arm.baseFromTool(this.q);
        return { links, places: Float32Array.from(tool.subarray(12, 15)), posed: 0 };
    }
}
