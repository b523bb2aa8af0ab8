// Motion of a scene by itself: its acts one after the other. Each moves a handle along a closed path.

/** Largest time step of a late frame, seconds. */
const MAX_STEP = 0.05;

export class Demo {
    #act = 0;
    #seconds = 0;
    #last;

    constructor(acts) {
        this.acts = acts;
    }

    /** Handle and offset of this frame; `begins` is true in the first frame of an act. `now` is in seconds. */
    advance(now = performance.now() / 1000) {
        const begins = this.#last === undefined || this.#seconds >= this.acts[this.#act].seconds;
        if (this.#last !== undefined && begins) {
            this.#act = (this.#act + 1) % this.acts.length;
            this.#seconds = 0;
        }
        if (!begins) this.#seconds += Math.min(now - this.#last, MAX_STEP);
        this.#last = now;
        const { handle, seconds, path } = this.acts[this.#act];
        return { handle, begins, offset: path(Math.min(1, this.#seconds / seconds)) };
    }
}
