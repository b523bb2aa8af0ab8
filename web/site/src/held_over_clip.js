// Drag of a body during playback: bones follow the clip, and held handles stay at their targets.
//
// A body deviates from its clip by some angles. In each frame those angles shrink a little and the clip advances; a
// drag then brings the held points back. So a body returns to its clip as far as held points allow, and completely
// after their release, without a jump.

/** Time in which the deviation from the clip shrinks to 1/e, seconds. */
const RETURN = 0.25;
/** Time in which a released handle returns to the clip, seconds. */
const FADE = 0.4;
/** Largest return of a joint in a frame while something is held, radians; a drag moves back by three times as much. */
const GENTLE = 0.05;
/** Negligible deviation from the clip, radians. */
const UNSEEN = 1e-4;

const smooth = (share) => share * share * (3 - 2 * share);

export class HeldOverClip {
    #away;
    #letGo = new Map();
    #held = new Map();

    /** True if the body deviates from its clip, or will. */
    get active() {
        return this.#away !== undefined || this.#held.size > 0 || this.#letGo.size > 0;
    }

    /**
     * Advances by `seconds` with these held points, `[handle, position]`. Returns the target of each, by the clip's
     * positions.
     */
    targets(held, seconds, placeInClip) {
        const now = new Map(held);
        for (const [handle, place] of this.#held) if (!now.has(handle)) this.#letGo.set(handle, { place, left: 1 });
        this.#held = now;
        const targets = new Map(now);
        for (const [handle, own] of this.#letGo) {
            own.left -= seconds / FADE;
            if (now.has(handle) || own.left <= 0) {
                this.#letGo.delete(handle);
                continue;
            }
            const home = placeInClip(handle);
            targets.set(handle, home.map((value, k) => value + (own.place[k] - value) * smooth(own.left)));
        }
        return targets;
    }

    /** Start of a frame: angles `seconds` nearer to those of the clip. */
    start(angles, seconds) {
        if (!this.#away) return angles;
        const most = Math.max(...this.#away.map(Math.abs));
        const gentle = this.#held.size > 0 ? 1 - GENTLE / Math.max(most, GENTLE) : 0;
        const share = Math.max(Math.exp(-seconds / RETURN), gentle);
        const away = this.#away.map((value) => share * value);
        this.#away = away.some((value) => Math.abs(value) > UNSEEN) ? away : undefined;
        return angles.map((value, k) => value + away[k]);
    }

    /** Result of a frame. */
    ended(angles, q) {
        this.#away = q.map((value, k) => value - angles[k]);
    }
}
