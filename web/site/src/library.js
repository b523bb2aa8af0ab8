// The worker, with one request at a time. Stopping it ends its current work.

/** Message of a stopped request. */
export const STOPPED = "Stopped.";

export class Library {
    #worker;
    #waiting = new Map();
    #next = 0;

    /** `module` is the promise of the library's module. */
    constructor(module) {
        this.module = module;
        this.#begin();
    }

    #begin() {
        const worker = new Worker(new URL("./worker.js", import.meta.url), { type: "module" });
        this.#worker = worker;
        this.#worker.onmessage = ({ data: { id, result, error, progress } }) => {
            const { resolve, reject, hear } = this.#waiting.get(id);
            if (progress) return hear?.(progress);
            this.#waiting.delete(id);
            return error === undefined ? resolve(result) : reject(new Error(error));
        };
        this.#worker.onerror = ({ message }) => this.#fail(new Error(message || "The worker cannot be fetched. Reload the page."));
        this.module.then((module) => worker.postMessage({ module }), (error) => this.#fail(error));
    }

    /** Sends a request; resolves to the worker's result. `hear` receives the progress of long requests. */
    ask(ask, what = {}, hear) {
        const id = (this.#next += 1);
        return new Promise((resolve, reject) => {
            this.#waiting.set(id, { resolve, reject, hear });
            // After the module, which the worker receives first.
            this.module.then(() => this.#worker.postMessage({ id, ask, ...what }), reject);
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
