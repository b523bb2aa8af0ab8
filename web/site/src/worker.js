// The library in a worker: requests and results are messages, so that the page never waits.
import { openSession } from "./session.js";

let session;

const handlers = {
    open({ files, ...options }) {
        session = openSession(files, options);
        return { ...session.describe(), ...session.show() };
    },
    grab: ({ handle, pins }) => session.grab(handle, pins),
    drag: ({ target }) => session.drag(target),
    skin: ({ method }) => session.skin(method),
    choose: ({ clip }) => session.choose(clip),
    play: (frame) => session.play(frame),
    follow: ({ movement }) => session.follow({ movement }),
    rest: () => session.rest(),
    /** Long request, for a separate worker. */
    whole: ({ files }, tell) => openSession(files, {}).whole(tell),
};

onmessage = ({ data: { id, ask, ...what } }) => {
    try {
        const result = handlers[ask](what, (progress) => postMessage({ id, progress }));
        const buffers = Object.values(result).filter(ArrayBuffer.isView).map(({ buffer }) => buffer);
        postMessage({ id, result }, { transfer: buffers });
    } catch (error) {
        postMessage({ id, error: error.message });
    }
};

// Messages before the module is loaded would be lost.
postMessage({ ready: true });
