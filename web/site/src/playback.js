// Playback time.

/** Largest time step of a late frame, seconds: a hidden page continues from its last time. */
const MAX_FRAME_TIME = 0.25;

export class Playback {
    running = false;
    /** Current time, seconds. */
    seconds = 0;
    #last = 0;

    /** Starts playback from the beginning, or stops it. */
    begin(running) {
        this.seconds = 0;
        this.running = running;
        this.#last = performance.now();
    }

    toggle() {
        this.running = !this.running;
        this.#last = performance.now();
    }

    /** Advances the time of a clip of this duration; returns the time and the step. */
    advance(length) {
        const now = performance.now();
        const passed = Math.min((now - this.#last) / 1000, MAX_FRAME_TIME);
        this.#last = now;
        this.seconds = (this.seconds + passed) % length;
        return { seconds: this.seconds, passed };
    }
}
