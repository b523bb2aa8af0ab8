// A rig: on its feet it has a free base and keeps its balance, any bone can be dragged, its skin follows.
import { Drag, ForwardKinematics, Problem, Robot, Solver, tasks } from "kinopt";
import { BodyPull } from "./body_pull.js";
import { CharacterSession } from "./character_session.js";
import { solutionTexts } from "./handles.js";
import { solesOf } from "./soles.js";

/** Numbers of a free base in a configuration: position and quaternion. */
const BASE_NUMBERS = 7;
/** Lowering of the root with bent knees and at rest, relative to its height: straight knees are singular. */
const [KNEES_BENT, AT_REST] = [1 / 15, 1 / 80];

export class RigSession extends CharacterSession {
    constructor(rig, { skinning = "lbs" }) {
        super();
        this.rig = rig;
        const { soles, feet, height, floor } = solesOf(rig);
        this.feet = feet;
        this.floor = floor;
        this.standing = feet.length > 0;
        const { model } = this.standing ? Robot.ofModel(rig.model, { baseJoint: "free" }) : rig;
        this.limits = { lower: model.lower, upper: model.upper };
        this.stands(rig.skeleton, model.neutral(), model);
        this.body = new BodyPull(model, { soles, height, masses: this.standing ? rig.masses : undefined, trunk: this.handles.frames[rig.skeleton.boneNames[0]], frames: this.handles.frames });
        if (this.standing) {
            this.body.stand(this.q);
            this.q = this.#bent(this.q);
        }
        this.start = this.q;
        this.skin(skinning);
    }

    /** The configuration with slightly bent knees, from one with knees bent by more. */
    #bent(q) {
        const frames = [this.model.frameNames[0], ...this.feet.map((foot) => this.handles.frames[foot])];
        const placed = new ForwardKinematics(this.model, frames).place(q).slice();
        const problem = new Problem(this.model, [
            ...frames.map((frame, k) => tasks.pose(frame, placed.subarray(16 * k, 16 * k + 16), { name: frame })),
            tasks.posture(q, { jointWeights: "upright" }),
        ]);
        const [root] = frames;
        const lower = (fraction) => {
            const placement = placed.slice(0, 16);
            placement[14] -= fraction * (placed[14] - this.floor);
            return { [root]: placement };
        };
        const bent = new Solver().solve(problem, q, lower(KNEES_BENT));
        return bent.reached ? new Drag(problem, bent.q).settle(lower(AT_REST)).q : q;
    }

    describe() {
        const { clip, constrained, triangles, notes } = this.rig;
        const [begin, end] = clip.isEmpty ? [0, 0] : clip.timeSpan;
        const pins = this.standing ? this.feet : constrained;
        return this.described({ up: "z", from: [1, 0.5, 0.25], pins, floor: this.floor, triangles, seconds: end - begin, notes });
    }

    skin(method) {
        this.posing?.free();
        this.posing = this.rig.triangles.length > 0 ? this.rig.posing(method) : undefined;
        return this.show();
    }

    /** A pin of the next bone is released, because both are the end of one limb. */
    grab(handle, pins, eye) {
        const { boneNames, parents } = this.skeleton;
        const next = (pin) => boneNames[parents[boneNames.indexOf(pin)]];
        const kept = pins.filter((pin) => next(pin) !== handle);
        const free = new Set(kept.filter((pin) => !this.feet.includes(pin)).map((pin) => this.handles.frames[pin]));
        this.body.grab(handle, kept, this.q, { free, eye });
        return {};
    }

    drag(target) {
        const begun = performance.now();
        const { solution, q, rests } = this.body.advance(target);
        this.q = q;
        const solved = performance.now() - begun;
        return { ...this.show(), ...solutionTexts(solution, this.model.reach), solved, rests };
    }

    within(q) {
        const { lower, upper } = this.limits;
        return q.map((value, k) => Math.min(Math.max(value, lower[k]), upper[k]));
    }

    /** A clip has the angles of the bones; the base is at rest. */
    clipAngles(seconds) {
        const angles = this.rig.clip.sample(seconds, "loop");
        return this.standing ? Float64Array.from([...this.start.slice(0, BASE_NUMBERS), ...angles]) : angles;
    }

    /** The pinned tips follow the clip, except the held ones. */
    stillBut(handles) {
        return this.rig.constrained.filter((name) => !handles.includes(name));
    }

    /** One problem for as long as the held points are the same. */
    draggingOver(_handles, points) {
        const key = points.join();
        if (this.over?.key !== key) {
            const only = this.standing ? { only: this.rig.model.jointNames, held: this.q } : {};
            const problem = new Problem(this.model, this.points(points, this.q), only);
            this.over = { key, dragging: new Drag(problem, this.q) };
        }
        return this.over.dragging;
    }

    rest() {
        this.q = this.start;
        return this.show();
    }

    show() {
        const angles = this.standing ? this.q.subarray(BASE_NUMBERS) : this.q;
        const shown = this.shown((posing) => posing.deform(angles));
        if (!this.standing) return shown;
        const { centre, polygon } = this.body.balance(this.q);
        return { ...shown, base: this.q.slice(0, BASE_NUMBERS), centre, polygon };
    }
}
