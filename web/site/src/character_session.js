// What rigs and files of animation share: bones that are grabbed, a skin that follows.
import { Drag, tasks } from "kinopt";
import { Handles, told } from "./handles.js";

export class CharacterSession {
    /** Stands at these angles of a skeleton. */
    stands(skeleton, q) {
        this.skeleton = skeleton;
        this.model = skeleton.model;
        this.q = q;
        const frames = skeleton.boneNames.map((bone) => [bone, skeleton.tip(bone)]);
        this.handles = new Handles(this.model, Object.fromEntries(frames));
    }

    described(more) {
        return { kind: "character", handles: this.handles.names, parents: this.skeleton.parents, ...more };
    }

    /** Drags `handle` by the problem that `state` makes of the points that are held. */
    drags(handle, held, state) {
        const points = [...new Set([...held, handle])].map((name) =>
            tasks.point(this.handles.frames[name], this.handles.place(this.q, name), { name }));
        this.grabbed = handle;
        this.dragging = new Drag(state(points), this.q);
        return {};
    }

    drag(target) {
        const begun = performance.now();
        const solution = this.dragging.advance({ [this.grabbed]: target });
        this.q = solution.q;
        const solved = performance.now() - begun;
        return { ...this.show(), ...told(solution, this.model.reach), solved, rests: this.dragging.rests };
    }

    /** The skin as `deform` moves it, and the places of the bones. */
    shown(deform) {
        const begun = performance.now();
        if (this.posing) deform(this.posing);
        const posed = performance.now() - begun;
        const skin = this.posing ? { positions: this.posing.positions.slice(), normals: this.posing.normals.slice() } : {};
        return { ...skin, places: this.handles.places(this.q), posed };
    }
}
