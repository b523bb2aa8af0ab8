// What a hand does to a body whose clip goes on: its bones stand where the clip has them, and what is held stays in the hand.
//
// A body is turned away from its clip by some angles. In each frame those shrink a little and the clip moves on; from there
// the points that are held are brought back. So a body comes to its clip again as nearly as what is held lets it, and all the
// way when it is let go, without a leap.

/** Seconds in which the angles away from the clip come to a third. */
const RETURN = 0.25;
/** Seconds in which what is let go comes back to the clip. */
const FADE = 0.4;
/** While something is held no joint returns by more than this in a frame, radians: a drag brings back three times as much. */
const GENTLE = 0.05;
/** Angles away from the clip that nobody sees, radians. */
const UNSEEN = 1e-4;

const smooth = (share) => share * share * (3 - 2 * share);

export class HeldOverClip {
    #away;
    #letGo = new Map();
    #held = new Map();

    /** Whether the body stands elsewhere than its clip has it, or will. */
    get active() {
        return this.#away !== undefined || this.#held.size > 0 || this.#letGo.size > 0;
    }

    /** Goes on by `seconds`, with these points held, `[handle, place]`: where each should be, by the places that the clip gives. */
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

    /** Where a frame begins: `seconds` nearer to the clip's angles. */
    start(angles, seconds) {
        if (!this.#away) return angles;
        const most = Math.max(...this.#away.map(Math.abs));
        const gentle = this.#held.size > 0 ? 1 - GENTLE / Math.max(most, GENTLE) : 0;
        const share = Math.max(Math.exp(-seconds / RETURN), gentle);
        const away = this.#away.map((value) => share * value);
        this.#away = away.some((value) => Math.abs(value) > UNSEEN) ? away : undefined;
        return angles.map((value, k) => value + away[k]);
    }

    /** Where it ended. */
    ended(angles, q) {
        this.#away = q.map((value, k) => value - angles[k]);
    }
}
