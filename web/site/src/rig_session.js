// A rig: its tips are pinned, any bone is grabbed, its skin follows.
import { Drag, Problem, tasks } from "kinopt";
import { Handles, told } from "./handles.js";

export class RigSession {
    constructor(rig, { skinning = "lbs" }) {
        this.rig = rig;
        this.model = rig.model;
        this.q = this.model.neutral();
        const bones = rig.skeleton.boneNames;
        this.handles = new Handles(this.model, Object.fromEntries(bones.map((bone) => [bone, rig.skeleton.tip(bone)])));
        this.hasSkin = rig.triangles.length > 0;
        this.skin(skinning);
    }

    describe() {
        const [from, to] = this.rig.clip.isEmpty ? [0, 0] : this.rig.clip.timeSpan;
        return {
            kind: "character",
            up: "z",
            from: [1, 0.5, 0.25],
            handles: this.handles.names,
            parents: this.rig.skeleton.parents,
            pins: this.rig.constrained,
            triangles: this.rig.triangles,
            seconds: to - from,
            notes: this.rig.notes,
        };
    }

    skin(method) {
        this.posing?.free();
        this.posing = this.hasSkin ? this.rig.posing(method) : undefined;
        return this.show();
    }

    grab(handle, pins) {
        const held = new Set([...pins, handle]);
        const points = [...held].map((name) =>
            tasks.point(this.handles.frames[name], this.handles.place(this.q, name), { name }));
        this.grabbed = handle;
        this.dragging = new Drag(new Problem(this.model, points), this.q);
        return {};
    }

    drag(target) {
        const begun = performance.now();
        const solution = this.dragging.advance({ [this.grabbed]: target });
        this.q = solution.q;
        const milliseconds = performance.now() - begun;
        return { ...this.show(), ...told(solution, this.model.reach), solved: milliseconds, rests: this.dragging.rests };
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
        const begun = performance.now();
        this.posing?.deform(this.q);
        const posed = performance.now() - begun;
        const skin = this.posing ? { positions: this.posing.positions.slice(), normals: this.posing.normals.slice() } : {};
        return { ...skin, places: this.handles.places(this.q), posed };
    }
}
