// A glTF scene or a motion capture: dragged from a pose of its clip; one of several clips is selected.
import { Drag, Problem } from "kinopt";
import { CharacterSession } from "./character_session.js";
import { HeldOverClip } from "./held_over_clip.js";

/** Parts of a scene that the library omits and the page draws. */
const DRAWN = /^(images|materials|textures|samplers)\b|TEXCOORD/;

export class AnimatedSession extends CharacterSession {
    constructor(thing, { skinning = "lbs", clip = 0 }) {
        super();
        this.thing = thing;
        this.clips = thing.clips ?? [thing.clip];
        this.clip = this.clips[clip];
        this.stand(this.thing.armature.rest);
        this.skin(skinning);
    }

    describe() {
        const triangles = this.posing?.triangles ?? new Uint32Array();
        const seconds = this.clip?.duration ?? 0;
        const clips = this.clips.map(({ name }) => name);
        const notes = this.thing.notes.filter((note) => !DRAWN.test(note));
        return this.described({ up: "y", from: [0.55, 0.3, 1], pins: [], triangles, seconds, clips, notes });
    }

    /** Selects another clip, at its start. */
    choose(clip) {
        this.clip = this.clips[clip];
        this.held = new HeldOverClip();
        this.stand(this.clip.sample(this.clip.start, "hold"));
        return { ...this.show(), seconds: this.clip.duration };
    }

    /** Sets the pose; the angles are relative to it. */
    stand(pose) {
        this.figure = this.thing.figure(pose);
        const { skeleton } = this.figure;
        this.stands(skeleton, skeleton.model.neutral());
    }

    skin(method) {
        this.posing?.free();
        this.posing = this.thing.posing?.(method);
        return this.show();
    }

    /** Without limits, the library selects the bones that stay. */
    grab(handle, pins) {
        const held = [...this.skeleton.holds([handle]), ...pins];
        return this.drags(handle, held, (points) => Problem.holding(this.skeleton, [handle], points, this.q));
    }

    /** The figure is in the clip's pose, so all angles of the clip are zero. */
    clipAngles(seconds) {
        this.stand(this.clip.sample(this.clip.start + seconds, "loop"));
        return this.q;
    }

    stillBut(handles) {
        return this.skeleton.holds(handles);
    }

    draggingOver(handles, points) {
        const problem = Problem.holding(this.skeleton, handles, this.points(points, this.model.neutral()), this.model.neutral());
        return new Drag(problem, this.q);
    }

    rest() {
        this.stand(this.thing.armature.rest);
        return this.show();
    }

    show() {
        return this.shown((posing) => posing.deform(this.figure.toPose(this.q)));
    }
}
