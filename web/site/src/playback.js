// The time of what plays.

/** Seconds that a picture which comes late counts as: a page that was out of sight goes on from where it was. */
const LATE = 0.25;

export class Playback {
    running = false;
    /** Where it is. */
    seconds = 0;
    #last = 0;

    /** Plays from the beginning, or not at all. */
    begin(running) {
        this.seconds = 0;
        this.running = running;
        this.#last = performance.now();
    }

    toggle() {
        this.running = !this.running;
        this.#last = performance.now();
    }

    /** Goes on: where something so long is now, and how much later than before. */
    advance(length) {
        const now = performance.now();
        const passed = Math.min((now - this.#last) / 1000, LATE);
        this.#last = now;
        this.seconds = (this.seconds + passed) % length;
        return { seconds: this.seconds, passed };
    }
}
