// A robot: any part of it can be dragged, around obstacles if there is a world; feet and pinned frames stay.
import { CollisionModel, ForwardKinematics, Problem, Solver, World, tasks } from "kinopt";
import { ArmPull } from "./arm_pull.js";
import { BodyPull } from "./body_pull.js";
import { solutionTexts } from "./handles.js";
import { Limbs } from "./limbs.js";
import { shapesOf } from "./robot_shapes.js";

/** With more limbs than this a robot starts in the pose of its file; arms start bent. */
const ARMS = 2;
/** Joints of a limb that can keep a position and an orientation while the body moves: a NAO's legs share one of six. */
const POSE_JOINTS = 4;

export class RobotSession {
    #arms = new Map();

    /** `read` reads the robot with the given base. */
    constructor(read, files, { world, floor, start, pose }) {
        this.robot = read({});
        this.limbs = new Limbs(this.robot);
        // A robot on its feet has a free base, not one at the file's first link.
        if (this.limbs.feet.length > 0) this.robot = read({ baseJoint: "free" });
        const { robot, limbs } = this;
        this.drawn = shapesOf(robot, files);
        this.kinematics = new ForwardKinematics(robot.model);
        this.frames = limbs.handles.map((name) => robot.model.frameNames.indexOf(name));
        this.boxes = world ?? [];
        this.floor = floor;
        this.start = start;
        this.pose = pose;
        this.surroundings = this.boxes.length > 0 ? surrounded(robot, this.boxes, floor) : undefined;
        const soles = Object.fromEntries(limbs.feet.map((foot) => [foot, robot.sole(foot)]));
        this.body = new BodyPull(robot.model, { soles, masses: massesOf(robot), height: limbs.height, trunk: limbs.body, surroundings: this.surroundings });
        this.rest();
        this.body.stand(this.q);
    }

    /** The arm that ends in `tip`; created when it is first used. */
    #arm(tip) {
        const { robot, limbs } = this;
        if (!this.#arms.has(tip)) this.#arms.set(tip, new ArmPull(robot, limbs.base, tip, limbs.chain(tip), this.surroundings));
        return this.#arms.get(tip);
    }

    describe() {
        const { limbs } = this;
        return {
            kind: "robot",
            up: "z",
            from: [0.55, -1, 0.35],
            handles: limbs.handles,
            ends: limbs.tips.length,
            pins: limbs.feet,
            names: this.robot.model.frameNames,
            shapes: this.drawn.shapes,
            sticks: this.drawn.sticks,
            gaps: this.drawn.gaps,
            boxes: this.boxes,
            floor: this.floor,
            seconds: 0,
            notes: [...this.robot.repairs, ...this.drawn.notes],
        };
    }

    skin() {
        return this.show();
    }

    rest() {
        const { tips, feet } = this.limbs;
        // Straight knees are singular.
        this.q = this.robot.crouchedConfiguration(feet, this.#posed(this.robot.model.neutral()));
        if (tips.length <= ARMS) for (const tip of tips) this.q = this.#arm(tip).bent(this.q, this.start);
        return this.show();
    }

    /** The configuration with the joints of the scene's pose at their values. */
    #posed(q) {
        if (!this.pose) return q;
        return new Solver().solve(new Problem(this.robot.model, [tasks.posture(q)], { locked: this.pose }), q).q;
    }

    /** A path follower drags the tool of an arm, unless another frame is pinned. */
    grab(handle, pins, eye) {
        const { tips, feet } = this.limbs;
        const alone = pins.every((name) => name === handle);
        const isTool = alone && feet.length === 0 && tips.includes(handle);
        this.pull = isTool ? this.#arm(handle) : this.body;
        // Limbs of few joints, such as legs of a quadruped, keep positions only.
        const free = new Set(pins.filter((pin) => this.limbs.chain(pin).length < POSE_JOINTS));
        this.pull.grab(handle, pins, this.q, { free, eye });
        return {};
    }

    drag(target) {
        const begun = performance.now();
        const { solution, q, rests } = this.pull.advance(target);
        this.q = q;
        const solved = performance.now() - begun;
        const { limits, ...more } = solutionTexts(solution, this.robot.model.reach);
        return { ...this.show(), ...more, limits: limits.map((joint) => this.limbs.handleOf(joint) ?? joint), solved, rests };
    }

    show() {
        const links = Float32Array.from(this.kinematics.place(this.q));
        const positions = this.frames.flatMap((frame) => [...links.subarray(16 * frame + 12, 16 * frame + 15)]);
        return { links, places: Float32Array.from(positions), posed: 0, ...this.body.balance(this.q) };
    }
}

/** Masses of a robot, if its file has any. */
function massesOf(robot) {
    try {
        return robot.masses;
    } catch {
        return undefined;
    }
}

/** Surroundings of a robot, `{ shapes, world }`: boxes, and the ground at a height. */
function surrounded(robot, boxes, floor) {
    const world = new World();
    if (floor !== undefined) world.addPlane("floor", [0, 0, floor]);
    for (const { name, size, at } of boxes) world.addBox(name, size, at);
    return { shapes: CollisionModel.ofRobot(robot), world };
}
