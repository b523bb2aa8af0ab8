import type { Numbers, Placement, Task, TaskOptions } from "./kinopt.js";

type Of<Kind extends Task["kind"]> = Extract<Task, { kind: Kind }>;
type Own<Kind extends Task["kind"], Named extends string> = Omit<Of<Kind>, "kind" | Named>;

/** Brings a frame's origin, or the place `at` in it, to a target. */
export function point(frame: string, target: Numbers, options?: Own<"point", "frame" | "target">): Of<"point">;
/** Brings a frame, or a tool on it, to a placement. */
export function pose(frame: string, target: Placement, options?: Own<"pose", "frame" | "target">): Of<"pose">;
/** Brings a frame to a placement in another frame, whichever of the two moves. */
export function relativePose(
    frame: string,
    base: string,
    target: Placement,
    options?: Own<"pose", "frame" | "base" | "target">,
): Of<"pose">;
/** Turns a frame as a placement is turned. */
export function orientation(
    frame: string,
    target: Placement,
    options?: Own<"orientation", "frame" | "target">,
): Of<"orientation">;
/** Points an axis of a frame at a place. */
export function lookAt(frame: string, axis: Numbers, target: Numbers, options?: TaskOptions): Of<"lookAt">;
/** Points an axis of a frame into a cone about the line of sight to a place; half its angle in radians. Outside alone costs. */
export function gaze(frame: string, axis: Numbers, halfAngle: number, target: Numbers, options?: TaskOptions): Of<"gaze">;
/** Points an axis of a frame into a cone about a direction of the world. */
export function gazeAlong(
    frame: string,
    axis: Numbers,
    halfAngle: number,
    direction: Numbers,
    options?: TaskOptions,
): Of<"gaze">;
/** Keeps the origins of two frames so far apart. */
export function distance(a: string, b: string, metres: number, options?: TaskOptions): Of<"distance">;
/** Keeps a frame's origin on the plane through a point across a normal. */
export function plane(frame: string, point: Numbers, normal: Numbers, options?: TaskOptions): Of<"plane">;
/** Keeps a frame's origin on the line from an eye through a place, as under a mouse. */
export function ray(frame: string, eye: Numbers, through: Numbers, options?: TaskOptions): Of<"ray">;
/** Has a camera see a frame's origin at a pixel (u, v). The camera is P by rows, twelve numbers: (u w, v w, w) = P (x, y, z, 1). */
export function pixel(frame: string, camera: Numbers, target: Numbers, options?: TaskOptions): Of<"pixel">;
/** Stays near a configuration, or near some joints' values by their names; a preference unless told otherwise. */
export function posture(
    reference: Of<"posture">["reference"],
    options?: Own<"posture", "reference">,
): Of<"posture">;
/** Moves slowly from where the joints stood so many seconds ago; a preference unless told otherwise. */
export function smoothness(
    previous: Numbers,
    timeStep: number,
    options?: Own<"smoothness", "previous" | "timeStep">,
): Of<"smoothness">;
/** Stays in the middle of the limits; a preference unless told otherwise. */
export function limitCentring(options?: TaskOptions): Of<"limitCentring">;
/** Brings the centre of mass to a place, or to one of two numbers at any height; `free` axes such as "z" do not count. */
export function centerOfMass(target: Numbers, options?: Own<"centerOfMass", "target">): Of<"centerOfMass">;
/** Keeps the centre of mass, seen from above, within the hull of points of the world, and `on` frames. */
export function supportPolygon(
    points?: readonly Numbers[],
    options?: Own<"supportPolygon", "points">,
): Of<"supportPolygon">;
/** Moves a frame at a velocity (`linear`, `angular`; still without them) since it stood at a placement so many seconds ago. */
export function frameVelocity(
    frame: string,
    previous: Placement,
    timeStep: number,
    options?: Own<"frameVelocity", "frame" | "previous" | "timeStep">,
): Of<"frameVelocity">;
/** Keeps a linear relation of joints: the sum of coefficients times values is `offset`. */
export function jointCoupling(
    coefficients: Readonly<Record<string, number>>,
    offset?: number,
    options?: TaskOptions,
): Of<"jointCoupling">;
/** Keeps Yoshikawa's measure of a frame at `least` or above; a preference unless told otherwise. */
export function manipulability(
    frame: string,
    least: number,
    options?: Own<"manipulability", "frame" | "least">,
): Of<"manipulability">;
/** Has another task cost only what lies beyond an interval, `{ lower, upper }`: a room, a floor, a least distance. */
export function bounded(task: Task, options?: Own<"bounded", "task">): Of<"bounded">;
