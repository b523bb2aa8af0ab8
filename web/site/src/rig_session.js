// A rig: its tips are pinned, any bone can be dragged, its skin follows.
import { Drag, Problem } from "kinopt";
import { CharacterSession } from "./character_session.js";

export class RigSession extends CharacterSession {
    constructor(rig, { skinning = "lbs" }) {
        super();
        this.rig = rig;
        const { lower, upper } = rig.model;
        this.limits = { lower, upper };
        this.stands(rig.skeleton, rig.model.neutral());
        this.skin(skinning);
    }

    describe() {
        const { clip, constrained: pins, triangles, notes } = this.rig;
        const [begin, end] = clip.isEmpty ? [0, 0] : clip.timeSpan;
        return this.described({ up: "z", from: [1, 0.5, 0.25], pins, triangles, seconds: end - begin, notes });
    }

    skin(method) {
        this.posing?.free();
        this.posing = this.rig.triangles.length > 0 ? this.rig.posing(method) : undefined;
        return this.show();
    }

    grab(handle, pins) {
        return this.drags(handle, pins, (points) => new Problem(this.model, points));
    }

    within(q) {
        const { lower, upper } = this.limits;
        return q.map((value, k) => Math.min(Math.max(value, lower[k]), upper[k]));
    }

    clipAngles(seconds) {
        return this.rig.clip.sample(seconds, "loop");
    }

    /** The pinned tips follow the clip, except the held ones. */
    stillBut(handles) {
        return this.rig.constrained.filter((name) => !handles.includes(name));
    }

    /** One problem for as long as the held points are the same. */
    draggingOver(_handles, points) {
        const key = points.join();
        if (this.over?.key !== key) {
            const problem = new Problem(this.model, this.points(points, this.q));
            this.over = { key, dragging: new Drag(problem, this.q) };
        }
        return this.over.dragging;
    }

    rest() {
        this.q = this.model.neutral();
        return this.show();
    }

    show() {
        return this.shown((posing) => posing.deform(this.q));
    }
}
