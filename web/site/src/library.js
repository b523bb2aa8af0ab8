// The worker, with one request at a time. Stopping it ends its current work.

/** Message of a stopped request. */
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
        this.#worker.onmessage = ({ data: { ready, id, result, error, progress } }) => {
            if (ready) return begun();
            const { resolve, reject, hear } = this.#waiting.get(id);
            if (progress) return hear?.(progress);
            this.#waiting.delete(id);
            return error === undefined ? resolve(result) : reject(new Error(error));
        };
        this.#worker.onerror = ({ message }) => {
            const unfetched = !message || /fetch/i.test(message);
            this.#fail(new Error(unfetched ? "The library cannot be fetched. Check that the server is running, and reload the page." : message));
        };
    }

    /** Sends a request; resolves to the worker's result. `hear` receives the progress of long requests. */
    ask(ask, what = {}, hear) {
        const id = (this.#next += 1);
        return new Promise((resolve, reject) => {
            this.#waiting.set(id, { resolve, reject, hear });
            this.#ready.then(() => this.#worker.postMessage({ id, ask, ...what }));
        });
    }

    /** Ends the current request, and starts a new worker without a model. */
    stop() {
        this.end();
        this.#begin();
    }

    /** Ends the worker. */
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
