// A whole motion, solved in a separate worker, so that playback continues and only this request is stopped.
import { Library } from "./library.js";

export class WholeMovement {
    #library;

    /** `module` is the promise of the library's module. */
    constructor(module) {
        this.module = module;
    }

    get goesOn() {
        return this.#library !== undefined;
    }

    /** Solves the motion of these files; `hear` receives the progress. Rejects if it is stopped. */
    async solve(files, hear) {
        const library = new Library(this.module);
        this.#library = library;
        try {
            return await library.ask("whole", { files }, hear);
        } finally {
            library.end();
            if (this.#library === library) this.#library = undefined;
        }
    }

    stop() {
        this.#library?.end();
    }
}
