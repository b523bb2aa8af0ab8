// The page: the opened model, the grabbed handle, playback, and the frame loop.
import { BodyView } from "./body_view.js";
import { codePanel } from "./code_panel.js";
import { Demo } from "./demo.js";
import { dropping } from "./dropping.js";
import { bytesOf, mergeFiles } from "./files.js";
import { hands } from "./hands.js";
import { hints } from "./hints.js";
import { Library, STOPPED } from "./library.js";
import { SCENES } from "./models.js";
import { fetchedModule } from "./module.js";
import { Playback } from "./playback.js";
import { Readout } from "./readout.js";
import { fragment, stateOf } from "./share.js";
import { Stage } from "./stage.js";
import { WholeMovement } from "./whole_movement.js";

const element = (id) => document.getElementById(id);

const module = fetchedModule((fraction) => (element("loading").value = fraction));

/** Creates the stage; reports a browser without WebGL. */
function staged() {
    try {
        return new Stage(element("stage"));
    } catch (error) {
        say("This page needs WebGL, which this browser does not support or has disabled.", true);
        throw error;
    }
}
const stage = staged();
const code = codePanel(element("code"), element("show-code"));
const library = new Library(module);
const whole = new WholeMovement(module);
const readout = new Readout(element("readout"));

const page = {
    view: undefined,
    opened: undefined,
    /** The request that opened the model, and its scene if it is the page's own. */
    asked: undefined,
    scene: undefined,
    /** Motion of the scene by itself, until somebody grabs. */
    demo: undefined,
    pins: new Set(),
    /** Positions of the pinned handles during playback. */
    kept: new Map(),
    grabbed: undefined,
    /** Target of the grabbed handle. */
    target: undefined,
    /** True if a drag moved the body away from the pose of its file or clip. */
    dragged: false,
    /** Message until a handle is grabbed, for frames without a message. */
    note: "",
    limits: [],
    method: "lbs",
    playback: new Playback(),
    /** Errors of a motion that was solved as a whole. */
    whole: undefined,
    busy: false,
    /** Milliseconds of solving and posing by frame, for tests. */
    frames: [],
    stage,
};
globalThis.kinoptPage = page;
const { playback } = page;

/** Separator of notes. */
const NOTE_SEPARATOR = " · ";

function say(words, bad = false) {
    element("status").textContent = words;
    element("status").classList.toggle("bad", bad);
}

const isBad = () => element("status").classList.contains("bad");

/** True if scenes move by themselves: not if the system prefers reduced motion. */
const moves = () => !matchMedia("(prefers-reduced-motion: reduce)").matches;

/** True if playback starts at once. */
const begins = ({ kind }) => (kind === "movement" || SCENES[page.scene]?.plays) && moves();

/** Opens a model of a scene or of files, in a shared state. After an error the page shows the library's message and keeps its model. */
async function open(modelRequest, name, { q, view } = {}) {
    page.opening = true;
    say(`Opening ${name}…`);
    const patience = setTimeout(() => (element("stop").hidden = false), 300);
    try {
        const request = { ...(await modelRequest), skinning: page.method, q };
        const opened = await library.ask("open", request);
        release();
        forget();
        whole.stop();
        page.asked = request;
        page.scene = name in SCENES ? name : undefined;
        page.whole = page.hovered = undefined;
        page.view?.remove();
        page.opened = opened;
        page.pins = new Set(opened.pins);
        page.limits = [];
        page.view = new BodyView(stage, opened, request.files);
        if (view) stage.view = view;
        page.frames.length = 0;
        readout.clear();
        element("poster").hidden = true;
        const { acts } = SCENES[page.scene] ?? {};
        page.demo = acts && moves() && !q ? new Demo(acts) : undefined;
        playback.begin(begins(opened));
        element("clip").replaceChildren(...(opened.clips ?? []).map((clip) => new Option(clip)));
        element("choose").setAttribute("aria-pressed", String(!page.scene));
        element("choose").textContent = page.scene ? "Your file" : `Your file: ${name}`;
        for (const button of document.querySelectorAll("[data-open]")) {
            button.setAttribute("aria-pressed", String(button.dataset.open === name));
        }
        // Notes about the page's own models are not shown.
        say(page.scene ? "" : opened.notes.join(NOTE_SEPARATOR));
        const drawn = page.view;
        drawn.dressed.then((notes) => drawn === page.view && notes.length > 0 && say([...opened.notes, ...notes].join(NOTE_SEPARATOR)));
    } catch (error) {
        say(/not given/.test(error.message) ? `${error.message}. Drop this file too.` : error.message, true);
        if (page.asked && error.message === STOPPED) await reopen();
    } finally {
        page.opening = false;
        clearTimeout(patience);
        element("stop").hidden = element("loading").hidden = true;
        tools();
    }
}

/** A restarted library has no model: the model is opened again, at rest. */
async function reopen() {
    release();
    forget();
    page.limits = [];
    page.whole = undefined;
    page.view.show(await library.ask("open", { ...page.asked, skinning: page.method }));
    playback.begin(begins(page.opened));
    mark();
}

/** Updates the tools to the opened model. */
function tools() {
    const { kind, triangles, seconds, clips } = page.opened ?? {};
    const [toDo, toDrop] = hints(page.opened, playback.running);
    element("to-do").textContent = toDo && `${toDo} Drag the background to rotate the view.`;
    element("to-drop").textContent = toDrop;
    code.show(page.scene);
    element("share").hidden = !page.scene;
    element("pin").hidden = kind === "movement";
    element("skin").hidden = !(triangles?.length > 0);
    element("play").hidden = kind === "robot";
    element("pin").textContent = (playback.running ? page.kept : page.pins).has(page.grabbed) ? "Unpin" : "Pin";
    element("skin").disabled = element("skin").hidden;
    element("skin").textContent = page.method === "lbs" ? "Skin: linear" : "Skin: dual quaternions";
    element("play").disabled = !(seconds > 0);
    element("play").textContent = playback.running ? "Pause" : "Play";
    element("clip").hidden = !(clips?.length > 1);
    element("rest").hidden = kind === "movement";
    element("whole").hidden = kind !== "movement";
    element("whole").disabled = whole.goesOn;
    element("whole").setAttribute("aria-pressed", String(page.whole !== undefined));
}

/** Sends a request to the library, and shows the result. */
async function shown(ask, what) {
    if (!page.view) return undefined;
    page.busy = true;
    try {
        const view = page.view;
        const result = await library.ask(ask, what);
        if (result.places && view === page.view) view.show(result);
        return result;
    } catch (error) {
        say(error.message, true);
        release();
        playback.running = false;
        tools();
        return undefined;
    } finally {
        page.busy = false;
    }
}

function release() {
    page.demo = undefined;
    page.grabbed = page.target = undefined;
    page.held = page.nudged = page.moved = false;
}

/** Discards the state of earlier drags. */
function forget() {
    page.kept.clear();
    page.dragged = false;
    page.note = "";
}

async function grab(name) {
    // A new action clears an error.
    if (isBad()) say("");
    page.demo = undefined;
    page.grabbed = name;
    page.note = "";
    page.nudged = false;
    page.target = page.view.place(name);
    page.moved = true;
    mark();
    tools();
    if (!playback.running) await shown("grab", grabRequest(name));
}

const grabRequest = (handle) => ({ handle, pins: [...page.pins], eye: stage.camera.position.toArray() });

const mark = () => page.view.mark({ ...page, pins: playback.running ? page.kept : page.pins });

/** Held and pinned handles during playback, with their targets. */
function heldOverClip() {
    const held = new Map([...page.kept].map(([name, position]) => [name, position.toArray()]));
    if (page.grabbed && (page.held || page.nudged)) held.set(page.grabbed, page.target.toArray());
    if (page.demo) {
        const { handle, begins: starts, offset } = page.demo.advance();
        if (starts) page.demo.start = page.view.place(handle);
        held.set(handle, page.demo.start.toArray().map((value, k) => value + offset[k]));
    }
    return [...held];
}

/** One frame of the scene's own motion. */
async function perform({ demo, view }) {
    if (demo.performs) return;
    demo.performs = true;
    const { handle, begins: starts, offset } = demo.advance();
    if (starts) {
        demo.start = view.place(handle);
        await shown("grab", grabRequest(handle));
    }
    if (demo === page.demo) follow(await shown("drag", { target: demo.start.toArray().map((value, k) => value + offset[k]) }));
    demo.performs = false;
}

async function step() {
    if (page.busy || page.opening || !page.view) return;
    if (playback.running) follow(await shown("play", { ...playback.advance(page.opened.seconds), held: heldOverClip() }));
    else if (page.demo) await perform(page);
    else if (page.target && page.moved) {
        // Targets that change meanwhile apply in the next frame.
        page.moved = false;
        const result = await shown("drag", { target: page.target.toArray() });
        if (!result) return;
        page.moved ||= page.held || !result.rests;
        follow(result);
    }
}

/** Shows the messages of a frame. */
function follow(result) {
    if (!result) return;
    page.frames.push({ solved: result.solved, posed: result.posed, steps: result.steps });
    // Bounds the memory of long sessions.
    if (page.frames.length > 100_000) page.frames.splice(0, 50_000);
    readout.frame(result);
    if (page.opened.handles.length === 0) return;
    page.limits = result.limits;
    mark();
    if (!isBad()) say(result.words || page.note);
}
(function loop() {
    step();
    requestAnimationFrame(loop);
})();

page.pointer = hands({ page, grab, release, mark, tools, say, press: (id) => element(id).click() });

element("pin").onclick = () => {
    const { grabbed } = page;
    if (!grabbed) return say("Select a joint first.");
    if (playback.running) {
        if (!page.kept.delete(grabbed)) page.kept.set(grabbed, page.held || page.nudged ? page.target : page.view.place(grabbed));
        page.nudged = false;
        mark();
        return tools();
    }
    if (!page.pins.delete(grabbed)) page.pins.add(grabbed);
    return grab(grabbed);
};
element("skin").onclick = () => {
    page.method = page.method === "lbs" ? "dqs" : "lbs";
    tools();
    return shown("skin", { method: page.method });
};
element("play").onclick = () => {
    release();
    // A clip moves every joint, so no part of a pose can stay; a message reports a lost pose.
    const lost = page.dragged && !playback.running;
    forget();
    page.limits = [];
    playback.toggle();
    page.note = lost ? "The clip replaces the dragged pose." : "";
    say(page.note);
    mark();
    tools();
};
element("clip").onchange = async ({ target }) => {
    const clip = target.selectedIndex;
    release();
    forget();
    page.limits = [];
    // A restarted library opens the model with this clip.
    page.asked.clip = clip;
    const { view } = page;
    const result = await shown("choose", { clip });
    if (!result || view !== page.view) return;
    page.opened.seconds = result.seconds;
    playback.begin(result.seconds > 0);
    say("");
    mark();
    tools();
};
element("rest").onclick = () => {
    release();
    forget();
    playback.begin(false);
    page.limits = [];
    if (page.view) mark();
    tools();
    say("");
    return shown("rest");
};
element("whole").onclick = async () => {
    const { view } = page;
    if (page.whole) {
        page.whole = undefined;
        tools();
        return shown("follow", {});
    }
    element("stop").hidden = false;
    try {
        const solving = whole.solve(page.asked.files, ({ done, total }) => say(`Whole motion: ${done} of ${total} frames`));
        say("Whole motion…");
        tools();
        const { movement, meanAngle, slip } = await solving;
        if (view !== page.view) return undefined;
        page.whole = { meanAngle, slip };
        say(`Whole motion: mean direction error ${meanAngle.toFixed(1)}°, largest drift of a foot contact ${(1000 * slip).toFixed(1)} mm.`);
        return await shown("follow", { movement });
    } catch (error) {
        if (view === page.view) say(error.message, error.message !== STOPPED);
        return undefined;
    } finally {
        element("stop").hidden = true;
        tools();
    }
};
element("stop").onclick = () => (whole.goesOn ? whole.stop() : library.stop());
for (const button of document.querySelectorAll("[data-open]")) {
    const { open: name } = button.dataset;
    button.onclick = () => open(SCENES[name].open(), name);
}

element("share").onclick = async () => {
    const result = page.opened.kind === "movement" ? {} : await library.ask("state");
    const address = new URL(fragment({ scene: page.scene, q: result.q, view: stage.view }), location.href).href;
    history.replaceState(undefined, "", address);
    const isCopied = await navigator.clipboard?.writeText(address).then(() => true, () => false);
    say(isCopied ? "The link to this pose is copied." : "The address of this page is the link to this pose.");
};

// Dropped or chosen files.
async function openFiles(list) {
    const files = [...(await list)];
    if (files.length === 0) return;
    const modelRequest = bytesOf(files).then((openedFiles) => ({
        files: page.opened?.kind === "movement" ? mergeFiles(page.asked.files, openedFiles) : openedFiles,
    }));
    await open(modelRequest, files[0].name);
}
dropping(openFiles);

/** Opens the scene of the address, or the first one. */
function openAddress() {
    const state = stateOf(location.hash);
    const scene = state?.scene in SCENES ? state.scene : "humanoid";
    return open(SCENES[scene].open(), scene, state?.scene === scene ? state : {});
}
addEventListener("hashchange", openAddress);
openAddress();
