// The tool of an arm in the hand: the arm's own engine follows it, and keeps how it is turned.
import { Arm } from "kinopt";
import { MARGIN } from "./body_pull.js";

/** How far a joint stands from the middle of its limits, as a share of its range, and radians at most: straight arms are singular. */
const [ASIDE, BENT] = [0.15, 0.6];

export class ArmPull {
    constructor(robot, base, tip, joints, surroundings) {
        // Few joints cannot turn a tool any way.
        const options = joints.length < 6 ? { goal: "position" } : {};
        this.arm = surroundings
            ? Arm.keepingClear(robot, base, tip, surroundings.shapes, surroundings.world, MARGIN, options)
            : new Arm(robot, base, tip, options);
    }

    /** The whole robot with this arm where it begins: bent, to this side and that of the middle of its limits, unless told otherwise. */
    bent(whole, start) {
        const { lower, upper } = this.arm;
        const begins = lower.map((low, k) => {
            const middle = Number.isFinite(low + upper[k]) ? 0.5 * (low + upper[k]) : 0;
            const aside = Math.min(BENT, ASIDE * (upper[k] - low));
            return k === 0 ? middle : middle + (k % 2 === 0 ? aside : -aside);
        });
        return this.arm.configuration(start ?? begins, whole);
    }

    /** Goes on from where the whole robot stands. */
    grab(_handle, _pins, whole) {
        this.whole = whole;
        this.q = this.arm.jointValues(whole);
        this.follower = this.arm.follower(this.q);
        this.target = this.arm.baseFromTool(this.q);
    }

    /** A frame: the tool to a place. */
    advance(place) {
        this.target.set(place, 12);
        const solution = this.follower.advance(this.target);
        const before = this.q;
        this.q = solution.q;
        this.whole = this.arm.configuration(this.q, this.whole);
        return { solution, q: this.whole, rests: this.q.every((value, k) => Math.abs(value - before[k]) < 1e-6) };
    }
}
