// Solve time, result and joints at limits of the last frames.

/** Frames whose times are averaged, because browsers round times, and milliseconds between two texts. */
const [AVERAGED, INTERVAL] = [30, 200];

/** A time in milliseconds, as microseconds with two digits. */
const microseconds = (time) => Math.max(1, Number((1000 * time).toPrecision(2))).toLocaleString("en");

export class Readout {
    #times = [];
    #shown = 0;

    constructor(element) {
        this.element = element;
    }

    clear() {
        this.#times = [];
        this.element.replaceChildren();
    }

    /** Shows a frame; `solved` is its time in milliseconds. `limits` is undefined for motions. */
    frame({ solved, steps, reached, limits }, now = performance.now()) {
        if (steps !== 0) this.#times.push(solved / (steps ?? 1));
        if (this.#times.length > AVERAGED) this.#times.shift();
        if (now - this.#shown < INTERVAL || this.#times.length === 0) return;
        this.#shown = now;
        const mean = this.#times.reduce((sum, time) => sum + time, 0) / this.#times.length;
        const count = limits.length;
        const lines = [
            ["solve", `${microseconds(mean)} µs`],
            ["target", reached ? "reached" : "not reached", reached ? "good" : "bad"],
            ["at limits", count === 0 ? "none" : `${count} ${count === 1 ? "joint" : "joints"}`],
        ];
        this.element.replaceChildren(...lines.flatMap(([label, value, look]) => {
            const [term, text] = ["dt", "dd"].map((kind) => document.createElement(kind));
            [term.textContent, text.textContent] = [label, value];
            if (look) text.className = look;
            return [term, text];
        }));
    }
}
