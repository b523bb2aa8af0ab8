// The pointer and the keys: what they grab, and where that should go.

const NUDGES = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
const BUTTONS = { p: "pin", s: "skin", " ": "play", r: "rest", w: "whole" };

/** Listens on the page's canvas. */
export function hands({ page, grab, release, mark, tools, say, press }) {
    const { stage } = page;
    const { canvas } = stage;

    /** Moves what is grabbed, and where it is kept. */
    function aim(target) {
        page.target = target;
        page.moved = true;
        if (page.kept.has(page.grabbed)) page.kept.set(page.grabbed, target);
    }

    // What is near enough is grabbed, all else turns the view.
    canvas.addEventListener("pointerdown", (event) => {
        const name = event.isPrimary && event.button === 0 ? page.view?.nearest(event.clientX, event.clientY) : undefined;
        stage.orbit.enabled = !name;
        if (!name) return;
        canvas.setPointerCapture(event.pointerId);
        page.held = true;
        grab(name);
    }, { capture: true });
    canvas.addEventListener("pointermove", (event) => {
        if (!page.held || !event.isPrimary) return;
        aim(stage.under(event.clientX, event.clientY, page.view.place(page.grabbed)) ?? page.target);
    });
    for (const end of ["pointerup", "pointercancel"]) {
        canvas.addEventListener(end, () => {
            page.held = false;
            stage.orbit.enabled = true;
        });
    }

    // Tab goes to a joint, arrows move it.
    canvas.addEventListener("keydown", (event) => {
        if (!page.view) return;
        const { handles } = page.opened;
        if (event.key === "Tab") {
            const at = handles.indexOf(page.grabbed) + (event.shiftKey ? -1 : 1);
            if (!(at in handles)) return;
            grab(handles[at]).then(() => say(handles[at]));
        } else if (event.key in NUDGES && page.grabbed) {
            const [right, up] = NUDGES[event.key];
            const { elements } = stage.camera.matrixWorld;
            const step = 0.01 * stage.size;
            const along = (k) => step * (right * elements[k] + up * elements[4 + k]);
            page.nudged = true;
            aim(page.target.clone().add({ x: along(0), y: along(1), z: along(2) }));
        } else if (event.key === "Escape") {
            release();
            mark();
            tools();
        } else if (event.key in BUTTONS) {
            press(BUTTONS[event.key]);
        } else {
            return;
        }
        event.preventDefault();
    });
}
