// The page: what is open, what is grabbed, and the loop that has the body follow.
import { BodyView } from "./body_view.js";
import { Library } from "./library.js";
import { MODELS } from "./models.js";
import { Stage } from "./stage.js";

const element = (id) => document.getElementById(id);
const stage = new Stage(element("stage"));
const library = new Library();

const page = {
    view: undefined,
    opened: undefined,
    /** What the library was asked for it. */
    asked: undefined,
    pins: new Set(),
    grabbed: undefined,
    /** Where what is grabbed should go. */
    target: undefined,
    limits: [],
    method: "lbs",
    playing: undefined,
    busy: false,
    /** Milliseconds of solving and posing, frame by frame, for the test and the curious. */
    frames: [],
    stage,
};
globalThis.kinoptPage = page;

function say(words, bad = false) {
    element("status").textContent = words;
    element("status").classList.toggle("bad", bad);
}

/** What is open, if all goes well; the library's message if not. */
async function open(wanted, name) {
    page.grabbed = page.target = page.playing = undefined;
    say(`Opening ${name}…`);
    const patience = setTimeout(() => (element("stop").hidden = false), 300);
    try {
        const asked = { ...(await wanted), skinning: page.method };
        const opened = await library.ask("open", asked);
        page.asked = asked;
        page.view?.remove();
        page.opened = opened;
        page.pins = new Set(opened.pins);
        page.view = new BodyView(stage, opened);
        page.frames.length = 0;
        for (const button of document.querySelectorAll("[data-open]")) {
            button.setAttribute("aria-pressed", String(button.dataset.open === name));
        }
        const isCharacter = opened.kind === "character";
        element("pin").disabled = !isCharacter;
        element("skin").disabled = !isCharacter || opened.triangles.length === 0;
        element("play").disabled = !(opened.seconds > 0);
        say(opened.notes.join(" "));
    } catch (error) {
        say(error.message, true);
        // A library that was stopped has forgotten what it had before.
        if (page.asked) page.view.show(await library.ask("open", { ...page.asked, skinning: page.method }));
    } finally {
        clearTimeout(patience);
        element("stop").hidden = true;
    }
}

/** Asks the library, and shows what it answers. */
async function shown(ask, what) {
    if (!page.view) return undefined;
    page.busy = true;
    try {
        const view = page.view;
        const told = await library.ask(ask, what);
        if (told.places && view === page.view) view.show(told);
        return told;
    } catch (error) {
        say(error.message, true);
        page.grabbed = page.target = undefined;
        return undefined;
    } finally {
        page.busy = false;
    }
}

async function grab(name) {
    page.playing = undefined;
    page.grabbed = name;
    page.target = page.view.place(name);
    page.moved = true;
    page.view.mark(page);
    await shown("grab", { handle: name, pins: [...page.pins] });
    element("pin").textContent = page.pins.has(name) ? "Free" : "Pin";
}

async function step() {
    if (page.playing !== undefined && !page.busy) {
        const seconds = (performance.now() - page.playing) / 1000;
        await shown("play", { seconds: seconds % page.opened.seconds });
    } else if (page.target && page.moved && !page.busy) {
        const told = await shown("drag", { target: page.target.toArray() });
        if (told) {
            page.frames.push({ solved: told.solved, posed: told.posed });
            page.moved = page.held || !told.rests;
            page.limits = told.limits;
            page.view.mark(page);
            if (told.words || !element("status").classList.contains("bad")) say(told.words.split("\n").slice(0, 2).join(" "));
        }
    }
}
(function loop() {
    step();
    requestAnimationFrame(loop);
})();

// Pointers: what is near enough is grabbed, all else turns the view.
const { canvas } = stage;
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
    page.target = stage.under(event.clientX, event.clientY, page.view.place(page.grabbed)) ?? page.target;
    page.moved = true;
});
for (const end of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(end, () => {
        page.held = false;
        stage.orbit.enabled = true;
    });
}

// Keys: tab to a joint, arrows move it.
const NUDGES = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
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
        page.target.set(page.target.x + along(0), page.target.y + along(1), page.target.z + along(2));
        page.moved = true;
    } else {
        const pressed = { p: "pin", s: "skin", " ": "play", r: "rest" }[event.key];
        if (!pressed) return;
        element(pressed).click();
    }
    event.preventDefault();
});

element("pin").onclick = () => {
    if (!page.grabbed) return say("Grab a joint first.");
    if (!page.pins.delete(page.grabbed)) page.pins.add(page.grabbed);
    return grab(page.grabbed);
};
element("skin").onclick = () => {
    page.method = page.method === "lbs" ? "dqs" : "lbs";
    element("skin").textContent = page.method === "lbs" ? "Skin: linear" : "Skin: dual quaternions";
    return shown("skin", { method: page.method });
};
element("play").onclick = () => {
    page.target = page.grabbed = undefined;
    page.playing = page.playing === undefined ? performance.now() : undefined;
    element("play").textContent = page.playing === undefined ? "Play" : "Pause";
};
element("rest").onclick = () => {
    page.target = page.grabbed = page.playing = undefined;
    page.limits = [];
    page.view?.mark(page);
    say("");
    return shown("rest");
};
element("stop").onclick = () => library.stop();
for (const button of document.querySelectorAll("[data-open]")) {
    const { open: name } = button.dataset;
    button.onclick = () => open(MODELS[name](), name);
}

// Files: dropped, or chosen.
async function openFiles(list) {
    const files = [...list];
    if (files.length === 0) return;
    const bytes = files.map(async (file) => [file.name, new Uint8Array(await file.arrayBuffer())]);
    await open(Promise.all(bytes).then((all) => ({ files: Object.fromEntries(all) })), files[0].name);
}
element("file").onchange = ({ target }) => openFiles(target.files);
const main = document.querySelector("main");
addEventListener("dragover", (event) => {
    event.preventDefault();
    main.classList.add("over");
});
addEventListener("dragleave", ({ relatedTarget }) => relatedTarget || main.classList.remove("over"));
addEventListener("drop", (event) => {
    event.preventDefault();
    main.classList.remove("over");
    openFiles(event.dataTransfer.files);
});

open(MODELS.humanoid(), "humanoid");
