// The worker, asked one thing at a time. Stopping it ends whatever it is at.

/** What is said of what was stopped. */
export const STOPPED = "Stopped.";

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
        this.#worker.onerror = ({ message }) => {
            const unfetched = !message || /fetch/i.test(message);
            this.#fail(new Error(unfetched ? "The library cannot be fetched: is the server still there? Then load the page again." : message));
        };
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
        this.#fail(new Error(STOPPED));
    }

    #fail(error) {
        const waiting = [...this.#waiting.values()];
        this.#waiting.clear();
        for (const { reject } of waiting) reject(error);
    }
}
