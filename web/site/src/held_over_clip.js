// Drag of a body during playback: bones follow the clip, and held handles stay at their targets.
//
// A body deviates from its clip by some angles. In each frame those angles shrink a little and the clip advances; a
// drag then brings the held points back. So a body returns to its clip as far as held points allow, and completely
// after their release, without a jump.

/** Time in which the deviation from the clip shrinks to 1/e, seconds. */
const RETURN_TIME = 0.25;
/** Time in which a released handle returns to the clip, seconds. */
const FADE_TIME = 0.4;
/** Largest return of a joint in a frame while something is held, radians; a drag moves back by three times as much. */
const MAX_RETURN_WHILE_HELD = 0.05;
/** Negligible deviation from the clip, radians. */
const MIN_OFFSET = 1e-4;

const smooth = (fraction) => fraction * fraction * (3 - 2 * fraction);

export class HeldOverClip {
    #offsets;
    #released = new Map();
    #held = new Map();

    /** True if the body deviates from its clip, or will. */
    get active() {
        return this.#offsets !== undefined || this.#held.size > 0 || this.#released.size > 0;
    }

    /**
     * Advances by `seconds` with these held points, `[handle, position]`. Returns the target of each, by the clip's
     * positions.
     */
    targets(held, seconds, positionInClip) {
        const heldPositions = new Map(held);
        for (const [handle, position] of this.#held) if (!heldPositions.has(handle)) this.#released.set(handle, { position, left: 1 });
        this.#held = heldPositions;
        const targets = new Map(heldPositions);
        for (const [handle, released] of this.#released) {
            released.left -= seconds / FADE_TIME;
            if (heldPositions.has(handle) || released.left <= 0) {
                this.#released.delete(handle);
                continue;
            }
            const home = positionInClip(handle);
            targets.set(handle, home.map((value, k) => value + (released.position[k] - value) * smooth(released.left)));
        }
        return targets;
    }

    /** Start of a frame: angles `seconds` nearer to those of the clip. */
    start(angles, seconds) {
        if (!this.#offsets) return angles;
        const maxOffset = Math.max(...this.#offsets.map(Math.abs));
        const minFraction = this.#held.size > 0 ? 1 - MAX_RETURN_WHILE_HELD / Math.max(maxOffset, MAX_RETURN_WHILE_HELD) : 0;
        const fraction = Math.max(Math.exp(-seconds / RETURN_TIME), minFraction);
        const offsets = this.#offsets.map((value) => fraction * value);
        this.#offsets = offsets.some((value) => Math.abs(value) > MIN_OFFSET) ? offsets : undefined;
        return angles.map((value, k) => value + offsets[k]);
    }

    /** Result of a frame. */
    ended(angles, q) {
        this.#offsets = q.map((value, k) => value - angles[k]);
    }
}
