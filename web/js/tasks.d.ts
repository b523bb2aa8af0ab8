import type { Numbers, Placement, Task, TaskOptions } from "./kinopt.js";

type Of<Kind extends Task["kind"]> = Extract<Task, { kind: Kind }>;
type Own<Kind extends Task["kind"], Named extends string> = Omit<Of<Kind>, "kind" | Named>;

/** Position of a frame's origin, or of the point `at` in its coordinates: three numbers, in the world or in the frame `base`. */
export function point(frame: string, target: Numbers, options?: Own<"point", "frame" | "target">): Of<"point">;
/** Pose of a frame, or of a tool on it: a placement in the world or in the frame `base`. */
export function pose(frame: string, target: Placement, options?: Own<"pose", "frame" | "target">): Of<"pose">;
/** Pose of a frame relative to the frame `base`; both frames may move. */
export function relativePose(
    frame: string,
    base: string,
    target: Placement,
    options?: Own<"pose", "frame" | "base" | "target">,
): Of<"pose">;
/** Orientation of a frame: the rotation of a placement, whose translation is ignored. */
export function orientation(
    frame: string,
    target: Placement,
    options?: Own<"orientation", "frame" | "target">,
): Of<"orientation">;
/** Points an axis of a frame, in its coordinates, at a position in the world. */
export function lookAt(frame: string, axis: Numbers, target: Numbers, options?: TaskOptions): Of<"lookAt">;
/**
 * Keeps an axis of a frame within a cone about the line of sight from the frame to a position in the world. `halfAngle`
 * is in radians. The error is the angle outside the cone.
 */
export function gaze(frame: string, axis: Numbers, halfAngle: number, target: Numbers, options?: TaskOptions): Of<"gaze">;
/** Keeps an axis of a frame within a cone about a direction in the world; `halfAngle` in radians. */
export function gazeAlong(
    frame: string,
    axis: Numbers,
    halfAngle: number,
    direction: Numbers,
    options?: TaskOptions,
): Of<"gaze">;
/** Distance between the origins of two frames, metres. */
export function distance(a: string, b: string, metres: number, options?: TaskOptions): Of<"distance">;
/** Keeps a frame's origin on a plane, given by a point and a normal in the world. */
export function plane(frame: string, point: Numbers, normal: Numbers, options?: TaskOptions): Of<"plane">;
/** Keeps a frame's origin on the line through two points of the world: the eye, and a point under the mouse. */
export function ray(frame: string, eye: Numbers, through: Numbers, options?: TaskOptions): Of<"ray">;
/**
 * Pixel (u, v) at which a camera sees a frame's origin. `camera` has the twelve numbers of a 3 x 4 matrix P by rows:
 * (u w, v w, w) = P (x, y, z, 1).
 */
export function pixel(frame: string, camera: Numbers, target: Numbers, options?: TaskOptions): Of<"pixel">;
/**
 * Nominal posture: a configuration, or values of some joints by name, radians or metres. Default role: "preference".
 */
export function posture(
    reference: Of<"posture">["reference"],
    options?: Own<"posture", "reference">,
): Of<"posture">;
/**
 * Slow motion of the joints from `previous`, their configuration `timeStep` seconds ago. Default role: "preference".
 */
export function smoothness(
    previous: Numbers,
    timeStep: number,
    options?: Own<"smoothness", "previous" | "timeStep">,
): Of<"smoothness">;
/** Keeps joints near the middle of their limits. Default role: "preference". */
export function limitCentring(options?: TaskOptions): Of<"limitCentring">;
/**
 * Position of the centre of mass: three numbers, or x and y at any height. `free` lists axes without a target, such as
 * "z" or "xy".
 */
export function centerOfMass(target: Numbers, options?: Own<"centerOfMass", "target">): Of<"centerOfMass">;
/**
 * Keeps the vertical projection of the centre of mass within the convex hull of support points. `points` are in the
 * world; `on` has points by frame, in the frame's coordinates.
 */
export function supportPolygon(
    points?: readonly Numbers[],
    options?: Own<"supportPolygon", "points">,
): Of<"supportPolygon">;
/**
 * Velocity of a frame since its placement `previous`, `timeStep` seconds ago. `linear` (m/s) and `angular` (rad/s) are
 * in world axes. Default: zero.
 */
export function frameVelocity(
    frame: string,
    previous: Placement,
    timeStep: number,
    options?: Own<"frameVelocity", "frame" | "previous" | "timeStep">,
): Of<"frameVelocity">;
/** Linear relation of joints: the sum of coefficients times joint values is `offset`. Default offset: 0. */
export function jointCoupling(
    coefficients: Readonly<Record<string, number>>,
    offset?: number,
    options?: TaskOptions,
): Of<"jointCoupling">;
/** Keeps Yoshikawa's manipulability measure of a frame at `least` or above. Default role: "preference". */
export function manipulability(
    frame: string,
    least: number,
    options?: Own<"manipulability", "frame" | "least">,
): Of<"manipulability">;
/**
 * Interval of another task: only the error outside `{ lower, upper }` has a cost. An example is a floor: a `plane` with
 * the interval `{ lower: 0 }`.
 */
export function bounded(task: Task, options?: Own<"bounded", "task">): Of<"bounded">;
