// What frames should do, as plain objects, under the names of the Python package's `kinopt.tasks`.

/** Brings a frame's origin, or the place `at` in it, to a target. */
export const point = (frame, target, options) => ({ ...options, kind: "point", frame, target });

/** Brings a frame, or a tool on it, to a placement. */
export const pose = (frame, target, options) => ({ ...options, kind: "pose", frame, target });

/** Brings a frame to a placement in another frame, whichever of the two moves. */
export const relativePose = (frame, base, target, options) => ({ ...options, kind: "pose", frame, base, target });

/** Turns a frame as a placement is turned. */
export const orientation = (frame, target, options) => ({ ...options, kind: "orientation", frame, target });

/** Points an axis of a frame at a place. */
export const lookAt = (frame, axis, target, options) => ({ ...options, kind: "lookAt", frame, axis, target });

/** Points an axis of a frame into a cone about the line of sight to a place. */
export const gaze = (frame, axis, halfAngle, target, options) => ({ ...options, kind: "gaze", frame, axis, halfAngle, target });

/** Points an axis of a frame into a cone about a direction of the world. */
export const gazeAlong = (frame, axis, halfAngle, direction, options) => ({ ...options, kind: "gaze", frame, axis, halfAngle, direction });

/** Keeps the origins of two frames so far apart. */
export const distance = (a, b, metres, options) => ({ ...options, kind: "distance", a, b, distance: metres });

/** Keeps a frame's origin on the plane through a point across a normal. */
export const plane = (frame, point, normal, options) => ({ ...options, kind: "plane", frame, point, normal });

/** Keeps a frame's origin on the line from an eye through a place, as under a mouse. */
export const ray = (frame, eye, through, options) => ({ ...options, kind: "ray", frame, eye, through });

/** Has a camera see a frame's origin at a pixel (u, v); the camera is P by rows, twelve numbers: (u w, v w, w) = P (x, y, z, 1). */
export const pixel = (frame, camera, target, options) => ({ ...options, kind: "pixel", frame, camera, target });

/** Stays near a configuration, or near some joints' values by their names. */
export const posture = (reference, options) => ({ ...options, kind: "posture", reference });

/** Moves slowly from where the joints stood so many seconds ago. */
export const smoothness = (previous, timeStep, options) => ({ ...options, kind: "smoothness", previous, timeStep });

/** Stays in the middle of the limits. */
export const limitCentring = (options) => ({ ...options, kind: "limitCentring" });

/** Brings the centre of mass to a place, or to one of two numbers at any height. */
export const centerOfMass = (target, options) => ({ ...options, kind: "centerOfMass", target });

/** Keeps the centre of mass, seen from above, within the hull of points of the world, and `on` frames. */
export const supportPolygon = (points, options) => ({ ...options, kind: "supportPolygon", points });

/** Moves a frame at a velocity since it stood at a placement so many seconds ago. */
export const frameVelocity = (frame, previous, timeStep, options) => ({ ...options, kind: "frameVelocity", frame, previous, timeStep });

/** Keeps a linear relation of joints: the sum of coefficients times values is `offset`. */
export const jointCoupling = (coefficients, offset, options) => ({ ...options, kind: "jointCoupling", coefficients, offset });

/** Keeps Yoshikawa's measure of a frame at `least` or above. */
export const manipulability = (frame, least, options) => ({ ...options, kind: "manipulability", frame, least });

/** Has another task cost only what lies beyond an interval, `{ lower, upper }`. */
export const bounded = (task, options) => ({ ...options, kind: "bounded", task });
