// Pointer and keyboard input: the grabbed handle and its target.

const NUDGES = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
/** Rotation of the view for an arrow key, radians, and zoom factor of a key. */
const [TURN_ANGLE, ZOOM_FACTOR] = [0.1, 1.1];
const ZOOMS = { "+": ZOOM_FACTOR, "=": ZOOM_FACTOR, "-": 1 / ZOOM_FACTOR };
const BUTTONS = { p: "pin", s: "skin", " ": "play", r: "rest", w: "whole" };

/** Adds the event listeners to the page's canvas. */
export function hands({ page, grab, release, mark, tools, say, press }) {
    const { stage } = page;
    const { canvas } = stage;

    /** Moves the target of the grabbed handle, and its pin. */
    function aim(target) {
        page.target = target;
        page.moved = page.dragged = true;
        if (page.kept.has(page.grabbed)) page.kept.set(page.grabbed, target);
    }

    const handleNear = ({ clientX, clientY }) => (page.opening ? undefined : page.view?.nearest(clientX, clientY));

    /** Highlights the handle that is or would be grabbed. */
    function point(name) {
        canvas.style.cursor = page.held ? "grabbing" : name ? "grab" : "move";
        if (name === page.hovered) return;
        page.hovered = name;
        if (page.view) mark();
    }

    /** Id of the pointer that drags. */
    let pointer;

    // A press near a handle grabs it; any other press rotates the view.
    canvas.addEventListener("pointerdown", (event) => {
        // A second pointer does not affect the first one's drag.
        if (page.held) return event.stopImmediatePropagation();
        const name = event.isPrimary && event.button === 0 ? handleNear(event) : undefined;
        stage.orbit.enabled = !name;
        if (!name) return undefined;
        canvas.setPointerCapture(event.pointerId);
        page.held = true;
        pointer = event.pointerId;
        point(name);
        return grab(name);
    }, { capture: true });
    canvas.addEventListener("pointermove", (event) => {
        if (!page.held && event.buttons === 0) point(handleNear(event));
        if (!page.held || event.pointerId !== pointer) return;
        aim(stage.under(event.clientX, event.clientY, page.view.place(page.grabbed)) ?? page.target);
    });
    for (const end of ["pointerup", "pointercancel"]) {
        canvas.addEventListener(end, (event) => {
            if (event.pointerId !== pointer) return;
            pointer = undefined;
            page.held = false;
            point(page.hovered);
            stage.orbit.enabled = true;
        });
    }

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
}
