// Files that are dropped onto the page or chosen.
import { dropped } from "./files.js";

const element = (id) => document.getElementById(id);

/** Calls `open` with a list of files, or its promise, for every drop or choice. */
export function dropping(open) {
    element("choose").onclick = () => element("file").click();
    element("file").onchange = ({ target }) => {
        open([...target.files]);
        // An edited file of the same name may be chosen again.
        target.value = "";
    };
    const main = document.querySelector("main");
    addEventListener("dragover", (event) => {
        event.preventDefault();
        main.classList.add("over");
    });
    addEventListener("dragleave", ({ relatedTarget }) => relatedTarget || main.classList.remove("over"));
    addEventListener("drop", (event) => {
        event.preventDefault();
        main.classList.remove("over");
        open(dropped(event.dataTransfer));
    });
}
