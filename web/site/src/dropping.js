// Files that come onto the page: dropped, or chosen.
import { dropped } from "./files.js";

const element = (id) => document.getElementById(id);

/** Gives `open` a list of files, or its promise, whenever some come. */
export function dropping(open) {
    element("choose").onclick = () => element("file").click();
    element("file").onchange = ({ target }) => {
        open([...target.files]);
        // The same file, mended, may be chosen again.
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
