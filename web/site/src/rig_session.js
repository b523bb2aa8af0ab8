// A rig: its tips are pinned, any bone is grabbed, its skin follows.
import { Problem } from "kinopt";
import { CharacterSession } from "./character_session.js";

export class RigSession extends CharacterSession {
    constructor(rig, { skinning = "lbs" }) {
        super();
        this.rig = rig;
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

    play(seconds) {
        this.q = this.rig.clip.sample(seconds, "loop");
        return this.show();
    }

    rest() {
        this.q = this.model.neutral();
        return this.show();
    }

    show() {
        return this.shown((posing) => posing.deform(this.q));
    }
}
