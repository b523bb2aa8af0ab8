// The worker, asked one thing at a time. Stopping it ends whatever it is at.

export class Library {
    #worker;
    #waiting = new Map();
    #next = 0;
    #ready;

    constructor() {
        this.#begin();
    }

    #begin() {
        this.#worker = new Worker(new URL("./worker.js", import.meta.url), { type: "module" });
        let begun;
        this.#ready = new Promise((resolve) => (begun = resolve));
        this.#worker.onmessage = ({ data: { ready, id, told, error, progress } }) => {
            if (ready) return begun();
            const { resolve, reject, hear } = this.#waiting.get(id);
            if (progress) return hear?.(progress);
            this.#waiting.delete(id);
            return error === undefined ? resolve(told) : reject(new Error(error));
        };
        this.#worker.onerror = ({ message }) => this.#fail(new Error(message || "the worker does not start"));
    }

    /** What the worker answers; `hear` is told how far it is, by what takes long. */
    ask(ask, what = {}, hear) {
        const id = (this.#next += 1);
        return new Promise((resolve, reject) => {
            this.#waiting.set(id, { resolve, reject, hear });
            this.#ready.then(() => this.#worker.postMessage({ id, ask, ...what }));
        });
    }

    /** Ends what goes on, and begins anew with nothing open. */
    stop() {
        this.end();
        this.#begin();
    }

    /** Ends for good. */
    end() {
        this.#worker.terminate();
        this.#fail(new Error("Stopped."));
    }

    #fail(error) {
        const waiting = [...this.#waiting.values()];
        this.#waiting.clear();
        for (const { reject } of waiting) reject(error);
    }
}
