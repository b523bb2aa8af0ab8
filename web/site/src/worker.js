// The library's side of the page: whatever is open, asked by messages, so that nothing here ever holds the page up.
import { openSession } from "./session.js";

let session;

const answers = {
    open({ files, skinning, world }) {
        session = openSession(files, { skinning, world });
        return { ...session.describe(), ...session.show() };
    },
    grab: ({ handle, pins }) => session.grab(handle, pins),
    drag: ({ target }) => session.drag(target),
    skin: ({ method }) => session.skin(method),
    play: ({ seconds }) => session.play(seconds),
    rest: () => session.rest(),
};

onmessage = ({ data: { id, ask, ...what } }) => {
    try {
        const told = answers[ask](what);
        const buffers = Object.values(told).filter(ArrayBuffer.isView).map(({ buffer }) => buffer);
        postMessage({ id, told }, { transfer: buffers });
    } catch (error) {
        postMessage({ id, error: error.message });
    }
};

// What is posted before the module is there is lost.
postMessage({ ready: true });
