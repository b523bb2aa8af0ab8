// A whole movement, solved in a worker of its own, so that what plays goes on and stopping ends nothing else.
import { Library } from "./library.js";

export class WholeMovement {
    #library;

    get goesOn() {
        return this.#library !== undefined;
    }

    /** The movement of these files; `hear` is told how far it is. Fails where it is stopped. */
    async solve(files, hear) {
        const library = new Library();
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
