import type { Numbers, Placement, Task, TaskOptions } from "./kinopt.js";

type Of<Kind extends Task["kind"]> = Extract<Task, { kind: Kind }>;
type Own<Kind extends Task["kind"], Named extends string> = Omit<Of<Kind>, "kind" | Named>;

/** Brings a frame's origin, or the place `at` in it, to a target. */
export function point(frame: string, target: Numbers, options?: Own<"point", "frame" | "target">): Of<"point">;
/** Brings a frame, or a tool on it, to a placement. */
export function pose(frame: string, target: Placement, options?: Own<"pose", "frame" | "target">): Of<"pose">;
/** Turns a frame as a placement is turned. */
export function orientation(
    frame: string,
    target: Placement,
    options?: Own<"orientation", "frame" | "target">,
): Of<"orientation">;
/** Points an axis of a frame at a place. */
export function lookAt(frame: string, axis: Numbers, target: Numbers, options?: TaskOptions): Of<"lookAt">;
/** Keeps a frame's origin on the plane through a point across a normal. */
export function plane(frame: string, point: Numbers, normal: Numbers, options?: TaskOptions): Of<"plane">;
/** Keeps a frame's origin on the line from an eye through a place, as under a mouse. */
export function ray(frame: string, eye: Numbers, through: Numbers, options?: TaskOptions): Of<"ray">;
/** Stays near a configuration. */
export function posture(reference: Numbers, options?: TaskOptions): Of<"posture">;
/** Stays in the middle of the limits. */
export function limitCentring(options?: TaskOptions): Of<"limitCentring">;
