// Drag of an arm's tool: a path follower keeps its orientation.
import { Arm } from "kinopt";
import { MARGIN } from "./body_pull.js";

/**
 * Initial offset of a joint from the middle of its limits, relative to its range and in radians at most: straight arms
 * are singular.
 */
const [RANGE_FRACTION, MAX_OFFSET] = [0.15, 0.6];

export class ArmPull {
    constructor(robot, base, tip, joints, surroundings) {
        // Few joints cannot reach every orientation.
        const options = joints.length < 6 ? { goal: "position" } : {};
        this.arm = surroundings
            ? Arm.keepingClear(robot, base, tip, surroundings.shapes, surroundings.world, MARGIN, options)
            : new Arm(robot, base, tip, options);
    }

    /**
     * The robot's configuration with this arm at its start: by default bent to alternating sides of the middle of its
     * limits.
     */
    bent(robotConfiguration, start) {
        const { lower, upper } = this.arm;
        const startAngles = lower.map((low, k) => {
            const middle = Number.isFinite(low + upper[k]) ? 0.5 * (low + upper[k]) : 0;
            const offset = Math.min(MAX_OFFSET, RANGE_FRACTION * (upper[k] - low));
            return k === 0 ? middle : middle + (k % 2 === 0 ? offset : -offset);
        });
        return this.arm.configuration(start ?? startAngles, robotConfiguration);
    }

    /** Continues from a configuration of the robot. */
    grab(_handle, _pins, robotConfiguration) {
        this.robotConfiguration = robotConfiguration;
        this.q = this.arm.jointValues(robotConfiguration);
        this.follower = this.arm.follower(this.q);
        this.target = this.arm.baseFromTool(this.q);
    }

    /** One frame: moves the tool to a position. */
    advance(position) {
        this.target.set(position, 12);
        const solution = this.follower.advance(this.target);
        const previous = this.q;
        this.q = solution.q;
        this.robotConfiguration = this.arm.configuration(this.q, this.robotConfiguration);
        return { solution, q: this.robotConfiguration, rests: this.q.every((value, k) => Math.abs(value - previous[k]) < 1e-6) };
    }
}
