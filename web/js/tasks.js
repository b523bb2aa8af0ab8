// What frames should do, as plain objects, under the names of the Python package's `kinopt.tasks`.

/** Brings a frame's origin, or the place `at` in it, to a target. */
export const point = (frame, target, options) => ({ ...options, kind: "point", frame, target });

/** Brings a frame, or a tool on it, to a placement. */
export const pose = (frame, target, options) => ({ ...options, kind: "pose", frame, target });

/** Turns a frame as a placement is turned. */
export const orientation = (frame, target, options) => ({ ...options, kind: "orientation", frame, target });

/** Points an axis of a frame at a place. */
export const lookAt = (frame, axis, target, options) => ({ ...options, kind: "lookAt", frame, axis, target });

/** Keeps a frame's origin on the plane through a point across a normal. */
export const plane = (frame, point, normal, options) => ({ ...options, kind: "plane", frame, point, normal });

/** Keeps a frame's origin on the line from an eye through a place, as under a mouse. */
export const ray = (frame, eye, through, options) => ({ ...options, kind: "ray", frame, eye, through });

/** Stays near a configuration. */
export const posture = (reference, options) => ({ ...options, kind: "posture", reference });

/** Stays in the middle of the limits. */
export const limitCentring = (options) => ({ ...options, kind: "limitCentring" });
