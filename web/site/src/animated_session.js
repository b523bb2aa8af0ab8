// A glTF scene or a capture: dragged from where its clip has it, on its feet.
import { Drag, Problem, tasks } from "kinopt";
import { Handles, told } from "./handles.js";

export class AnimatedSession {
    constructor(thing, { skinning = "lbs" }) {
        this.thing = thing;
        this.clip = thing.clips ? thing.clips[0] : thing.clip;
        this.stand(undefined);
        this.skin(skinning);
    }

    describe() {
        return {
            kind: "character",
            up: "y",
            from: [0.55, 0.3, 1],
            handles: this.handles.names,
            parents: this.figure.skeleton.parents,
            pins: [],
            triangles: this.posing?.triangles ?? new Uint32Array(),
            seconds: this.clip?.duration ?? 0,
            notes: this.thing.notes,
        };
    }

    /** Has it stand in a pose, at rest without one; its angles count from there. */
    stand(pose) {
        this.figure = this.thing.figure(pose);
        const { skeleton } = this.figure;
        this.q = skeleton.model.neutral();
        const frames = skeleton.boneNames.map((bone) => [bone, skeleton.tip(bone)]);
        this.handles = new Handles(skeleton.model, Object.fromEntries(frames));
    }

    skin(method) {
        this.posing?.free();
        this.posing = this.thing.posing?.(method);
        return this.show();
    }

    grab(handle, pins) {
        const { skeleton } = this.figure;
        const held = new Set([...skeleton.holds([handle]), ...pins, handle]);
        const points = [...held].map((name) =>
            tasks.point(this.handles.frames[name], this.handles.place(this.q, name), { name }));
        this.grabbed = handle;
        this.dragging = new Drag(Problem.holding(skeleton, [handle], points, this.q), this.q);
        return {};
    }

    drag(target) {
        const begun = performance.now();
        const solution = this.dragging.advance({ [this.grabbed]: target });
        this.q = solution.q;
        const milliseconds = performance.now() - begun;
        return { ...this.show(), ...told(solution, this.figure.skeleton.model.reach), solved: milliseconds, rests: this.dragging.rests };
    }

    play(seconds) {
        this.stand(this.clip.sample(seconds, "loop"));
        return this.show();
    }

    rest() {
        this.stand(undefined);
        return this.show();
    }

    show() {
        const begun = performance.now();
        this.posing?.deform(this.figure.toPose(this.q));
        const posed = performance.now() - begun;
        const skin = this.posing ? { positions: this.posing.positions.slice(), normals: this.posing.normals.slice() } : {};
        return { ...skin, places: this.handles.places(this.q), posed };
    }
}
