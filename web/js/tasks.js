// Tasks of frames as plain objects, under the names of the Python package's `kinopt.tasks`.

/** Position of a frame's origin, or of the point `at` in it. */
export const point = (frame, target, options) => ({ ...options, kind: "point", frame, target });

/** Pose of a frame, or of a tool on it. */
export const pose = (frame, target, options) => ({ ...options, kind: "pose", frame, target });

/** Pose of a frame relative to another frame; either of them may move. */
export const relativePose = (frame, base, target, options) => ({ ...options, kind: "pose", frame, base, target });

/** Orientation of a frame. */
export const orientation = (frame, target, options) => ({ ...options, kind: "orientation", frame, target });

/** Points an axis of a frame at a position. */
export const lookAt = (frame, axis, target, options) => ({ ...options, kind: "lookAt", frame, axis, target });

/** Keeps an axis of a frame within a cone about the line of sight to a position. */
export const gaze = (frame, axis, halfAngle, target, options) => ({ ...options, kind: "gaze", frame, axis, halfAngle, target });

/** Keeps an axis of a frame within a cone about a direction of the world. */
export const gazeAlong = (frame, axis, halfAngle, direction, options) => ({ ...options, kind: "gaze", frame, axis, halfAngle, direction });

/** Distance between the origins of two frames. */
export const distance = (a, b, metres, options) => ({ ...options, kind: "distance", a, b, distance: metres });

/** Keeps a frame's origin on a plane, given by a point and a normal. */
export const plane = (frame, point, normal, options) => ({ ...options, kind: "plane", frame, point, normal });

/** Keeps a frame's origin on a line from an eye through a point, as under a mouse. */
export const ray = (frame, eye, through, options) => ({ ...options, kind: "ray", frame, eye, through });

/**
 * A frame's origin appears at a pixel (u, v) of a camera. The camera is P by rows, twelve numbers, with (u w, v w, w) =
 * P (x, y, z, 1).
 */
export const pixel = (frame, camera, target, options) => ({ ...options, kind: "pixel", frame, camera, target });

/** Nominal posture: a configuration, or the values of some joints by name. */
export const posture = (reference, options) => ({ ...options, kind: "posture", reference });

/** Slow motion of the joints from their values `timeStep` seconds ago. */
export const smoothness = (previous, timeStep, options) => ({ ...options, kind: "smoothness", previous, timeStep });

/** Keeps joints near the middle of their limits. */
export const limitCentring = (options) => ({ ...options, kind: "limitCentring" });

/** Position of the centre of mass: three numbers, or two at any height. */
export const centerOfMass = (target, options) => ({ ...options, kind: "centerOfMass", target });

/** Keeps the vertical projection of the centre of mass within the hull of points of the world, and `on` frames. */
export const supportPolygon = (points, options) => ({ ...options, kind: "supportPolygon", points });

/** Velocity of a frame since its placement `timeStep` seconds ago. */
export const frameVelocity = (frame, previous, timeStep, options) => ({ ...options, kind: "frameVelocity", frame, previous, timeStep });

/** Linear relation of joints: the sum of coefficients times values is `offset`. */
export const jointCoupling = (coefficients, offset, options) => ({ ...options, kind: "jointCoupling", coefficients, offset });

/** Keeps Yoshikawa's manipulability measure of a frame at `least` or above. */
export const manipulability = (frame, least, options) => ({ ...options, kind: "manipulability", frame, least });

/** Interval `{ lower, upper }` of another task: only the part outside it has a cost. */
export const bounded = (task, options) => ({ ...options, kind: "bounded", task });
