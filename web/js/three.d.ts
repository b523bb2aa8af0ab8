import type { Camera, Group, Material, Mesh, Object3D, Vector3 } from "three";
import type { Numbers, Shape } from "./kinopt.js";

/** Mesh of a shape that is not a mesh file. */
export function shapeMesh(shape: Shape, material?: Material): Mesh;

/** Links of a robot, a group for each frame. */
export class RobotLinks extends Group {
    /**
     * `shapes` are those of each frame, as `robot.shapes` returns. `create` returns the object of a shape of the frame
     * with this index; shapes without an object are omitted. By default mesh files are.
     */
    constructor(shapes: readonly (readonly Shape[])[], create?: (shape: Shape, frame: number) => Object3D | undefined);
    /** Moves the frames to their placements, sixteen numbers each, as `ForwardKinematics.place` returns. */
    place(placements: Numbers | Float32Array): void;
}

/** Mesh that moves with its skeleton. */
export class Skin extends Mesh {
    /** `triangles` are vertex indices, as `rig.triangles`. Without normals the mesh is flat-shaded. */
    constructor(triangles: Uint32Array, positions: Float32Array, normals: Float32Array, material?: Material);
    /** Moves the vertices, as `posing.positions` and `posing.normals`. */
    update(positions: Float32Array, normals: Float32Array): void;
}

export interface PointerDragOptions {
    /** Pairs of a name and its position in the world. */
    handles(): Iterable<readonly [string, Vector3]>;
    grab?(name: string): void;
    /** `target` is the position under the pointer at the handle's depth. */
    drag?(name: string, target: Vector3): void;
    release?(name: string): void;
    /** The handle that a press would take, if any. */
    hover?(name: string | undefined): void;
    /** Controls of the camera, such as OrbitControls; disabled during a drag. */
    controls?: { enabled: boolean };
}

/** Drags of named handles by a pointer: mouse, pen or finger. */
export class PointerDrag {
    constructor(canvas: HTMLElement, camera: Camera, options: PointerDragOptions);
    /** Name of the handle that is dragged. */
    readonly held: string | undefined;
    /** Name of the handle that a press would take. */
    readonly hovered: string | undefined;
    /** Position on the page, pixels. */
    toScreen(position: Vector3): { x: number; y: number };
    /** Name of the handle at a position on the page, within a finger's size. */
    nearest(x: number, y: number): string | undefined;
    /** Position in the world below a position on the page, at the depth of another position. */
    under(x: number, y: number, depthOf: Vector3): Vector3 | null;
}
