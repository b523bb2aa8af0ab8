// Pointer and keyboard input: the grabbed handle and its target.
import { PointerDrag } from "kinopt/three";

const NUDGES = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
/** Rotation of the view for an arrow key, radians, and zoom factor of a key. */
const [TURN_ANGLE, ZOOM_FACTOR] = [0.1, 1.1];
const ZOOMS = { "+": ZOOM_FACTOR, "=": ZOOM_FACTOR, "-": 1 / ZOOM_FACTOR };
const BUTTONS = { p: "pin", s: "skin", " ": "play", r: "rest", w: "whole" };

/** Adds the event listeners to the page's canvas; returns the drags of its pointers. */
export function hands({ page, grab, release, mark, tools, say, press }) {
    const { stage } = page;
    const { canvas } = stage;

    /** Moves the target of the grabbed handle, and its pin. */
    function aim(target) {
        page.target = target;
        page.moved = page.dragged = true;
        if (page.kept.has(page.grabbed)) page.kept.set(page.grabbed, target);
    }

    // A press near a handle grabs it; any other press rotates the view.
    const pointer = new PointerDrag(canvas, stage.camera, {
        controls: stage.orbit,
        handles: () => (page.opening || !page.view ? [] : page.view.handles()),
        grab(name) {
            page.held = true;
            return grab(name);
        },
        drag: (_, target) => page.held && aim(target),
        release: () => (page.held = false),
        hover(name) {
            page.hovered = name;
            if (page.view) mark();
        },
    });

    // J selects a joint, arrow keys move it; without a selection they rotate the view.
    canvas.addEventListener("keydown", (event) => {
        if (!page.view || page.opening || event.ctrlKey || event.metaKey || event.altKey) return;
        const { handles } = page.opened;
        const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
        if (key === "j" && handles.length > 0) {
            const index = handles.indexOf(page.grabbed) + (event.shiftKey ? -1 : 1);
            const name = handles.at(index % handles.length);
            grab(name).then(() => say(name));
        } else if (key in ZOOMS) {
            stage.nearer(ZOOMS[key]);
        } else if (key in NUDGES && !page.grabbed) {
            stage.turn(...NUDGES[key].map((direction) => TURN_ANGLE * direction));
        } else if (key in NUDGES) {
            const [right, up] = NUDGES[key];
            const { elements } = stage.camera.matrixWorld;
            const step = 0.01 * stage.size;
            const along = (k) => step * (right * elements[k] + up * elements[4 + k]);
            page.nudged = true;
            aim(page.target.clone().add({ x: along(0), y: along(1), z: along(2) }));
        } else if (key === "Escape") {
            release();
            mark();
            tools();
        } else if (key in BUTTONS) {
            press(BUTTONS[key]);
        } else {
            return;
        }
        event.preventDefault();
    });
    return pointer;
}
