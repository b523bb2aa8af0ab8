// The library in a worker: requests and results are messages, so that the page never waits.
import { initSync } from "kinopt";
import { openSession } from "./session.js";

let session;

const handlers = {
    open({ files, q, ...options }) {
        session = openSession(files, options);
        // A configuration of an address, if it is one of this model.
        if (q && q.length === session.q?.length) session.q = Float64Array.from(q);
        return { ...session.describe(), ...session.show() };
    },
    grab: ({ handle, pins, eye }) => session.grab(handle, pins, eye),
    drag: ({ target }) => session.drag(target),
    skin: ({ method }) => session.skin(method),
    choose: ({ clip }) => session.choose(clip),
    play: (frame) => session.play(frame),
    follow: ({ movement }) => session.follow({ movement }),
    rest: () => session.rest(),
    /** Configuration of the model, for an address. */
    state: () => ({ q: Array.from(session.q) }),
    /** Long request, for a separate worker. */
    whole: ({ files }, tell) => openSession(files, {}).whole(tell),
};

onmessage = ({ data: { module, id, ask, ...what } }) => {
    if (module) return initSync({ module });
    try {
        const result = handlers[ask](what, (progress) => postMessage({ id, progress }));
        const buffers = Object.values(result).filter(ArrayBuffer.isView).map(({ buffer }) => buffer);
        return postMessage({ id, result }, { transfer: buffers });
    } catch (error) {
        return postMessage({ id, error: error.message });
    }
};
