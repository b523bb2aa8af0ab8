// Common code of rigs and animation files: bones that are dragged, a skin that follows, a clip that plays.
import { Drag, tasks } from "kinopt";
import { Handles, solutionTexts } from "./handles.js";
import { HeldOverClip } from "./held_over_clip.js";

/** Largest time step of a late frame, seconds. */
const MAX_STEP = 0.1;

export class CharacterSession {
    held = new HeldOverClip();

    /** Sets the configuration of a skeleton; `model` has a base if it is not the skeleton's own. */
    stands(skeleton, q, model = skeleton.model) {
        this.skeleton = skeleton;
        this.model = model;
        this.q = q;
        const frames = skeleton.boneNames.map((bone) => [bone, skeleton.tip(bone)]);
        this.handles = new Handles(this.model, Object.fromEntries(frames));
    }

    described(more) {
        return { kind: "character", handles: this.handles.names, parents: this.skeleton.parents, ...more };
    }

    /** Point tasks that keep the tips of these bones at their positions at `q`. */
    points(names, q) {
        return [...new Set(names)].map((name) => tasks.point(this.handles.frames[name], this.handles.place(q, name), { name }));
    }

    /** Starts a drag of `handle` with the problem that `state` creates from the point tasks. */
    drags(handle, held, state) {
        this.grabbed = handle;
        this.dragging = new Drag(state(this.points([...held, handle], this.q)), this.q);
        return {};
    }

    drag(target) {
        const begun = performance.now();
        const solution = this.dragging.advance({ [this.grabbed]: target });
        this.q = solution.q;
        const solved = performance.now() - begun;
        return { ...this.show(), ...solutionTexts(solution, this.model.reach), solved, rests: this.dragging.isAtRest };
    }

    /** Clamps angles to the limits, if there are any. */
    within(q) {
        return q;
    }

    /** One frame of the clip, with held handles at their targets, `[handle, position]`. */
    play({ seconds, passed, held }) {
        const begun = performance.now();
        const angles = this.clipAngles(seconds);
        const step = Math.min(passed, MAX_STEP);
        const targets = this.held.targets(held, step, (handle) => this.handles.place(angles, handle));
        this.q = this.within(this.held.start(angles, step));
        let words = { reached: true, limits: [], words: "" };
        if (targets.size > 0) {
            const handles = [...targets.keys()];
            const still = this.stillBut(handles);
            const dragging = this.draggingOver(handles, [...still, ...handles]);
            dragging.setConfiguration(this.q);
            const clipPositions = still.map((name) => [name, this.handles.place(angles, name)]);
            const solution = dragging.advance(Object.fromEntries([...clipPositions, ...targets]));
            this.q = solution.q;
            this.held.ended(angles, this.q);
            words = solutionTexts(solution, this.model.reach);
        }
        const solved = performance.now() - begun;
        return { ...this.show(), ...words, solved };
    }

    /** Skin after `deform`, and positions of the bones. */
    shown(deform) {
        const begun = performance.now();
        if (this.posing) deform(this.posing);
        const posed = performance.now() - begun;
        const skin = this.posing ? { positions: this.posing.positions.slice(), normals: this.posing.normals.slice() } : {};
        return { ...skin, places: this.handles.places(this.q), posed };
    }
}
