// Drawing and dragging with three.js: links of a robot, a skin, and handles under a pointer. The functions take numbers,
// so that the library may be in a worker.
import * as THREE from "three";

/** Distance from a pointer within which it takes a handle, pixels: about the size of a finger. */
const GRASP = 60;

const material = (color) => new THREE.MeshStandardMaterial({ color, roughness: 0.6 });

/** Mesh of a shape that is not a mesh file; cylinders and capsules of the library are along z, those of three.js along y. */
export function shapeMesh({ kind, size, radius, length, radii }, shapeMaterial = material(0xdcdcda)) {
    const geometries = {
        box: () => new THREE.BoxGeometry(...size),
        sphere: () => new THREE.SphereGeometry(radius, 32, 20),
        ellipsoid: () => new THREE.SphereGeometry(1, 32, 20).scale(...radii),
        cylinder: () => new THREE.CylinderGeometry(radius, radius, length, 40).rotateX(Math.PI / 2),
        capsule: () => new THREE.CapsuleGeometry(radius, length, 10, 40).rotateX(Math.PI / 2),
    };
    if (!(kind in geometries)) throw new Error(`shape of kind ${kind}: expected ${Object.keys(geometries).join(", ")}`);
    return new THREE.Mesh(geometries[kind](), shapeMaterial);
}

/** Links of a robot, a group for each frame. */
export class RobotLinks extends THREE.Group {
    /**
     * `shapes` are those of each frame, as `robot.shapes` returns. `create` returns the object of a shape of the frame
     * with this index; shapes without an object are omitted. By default mesh files are.
     */
    constructor(shapes, create = (shape) => (shape.kind === "mesh" ? undefined : shapeMesh(shape))) {
        super();
        shapes.forEach((ofFrame, k) => {
            const link = new THREE.Group();
            link.matrixAutoUpdate = false;
            for (const shape of ofFrame) {
                const object = create(shape, k);
                if (!object) continue;
                object.matrixAutoUpdate = false;
                object.matrix.fromArray(shape.linkFromShape);
                if (shape.scale) object.matrix.scale(new THREE.Vector3(...shape.scale));
                link.add(object);
            }
            this.add(link);
        });
    }

    /** Moves the frames to their placements, sixteen numbers each, as `ForwardKinematics.place` returns. */
    place(placements) {
        this.children.forEach((link, k) => {
            for (let j = 0; j < 16; j += 1) link.matrix.elements[j] = placements[16 * k + j];
            link.matrixWorldNeedsUpdate = true;
        });
    }
}

/** Mesh that moves with its skeleton. */
export class Skin extends THREE.Mesh {
    /** `triangles` are vertex indices, as `rig.triangles`. Without normals the mesh is flat-shaded. */
    constructor(triangles, positions, normals, skinMaterial = material(0xb9c3cc)) {
        super(new THREE.BufferGeometry(), skinMaterial);
        const dynamic = (numbers) => new THREE.BufferAttribute(Float32Array.from(numbers), 3).setUsage(THREE.DynamicDrawUsage);
        this.geometry.setIndex(new THREE.BufferAttribute(triangles, 1));
        this.geometry.setAttribute("position", dynamic(positions));
        if (normals.length > 0) this.geometry.setAttribute("normal", dynamic(normals));
        else skinMaterial.flatShading = true;
        // The bounding volume of a moving mesh changes.
        this.frustumCulled = false;
    }

    /** Moves the vertices, as `posing.positions` and `posing.normals`. */
    update(positions, normals) {
        const { position, normal } = this.geometry.attributes;
        position.array.set(positions);
        position.needsUpdate = true;
        normal?.array.set(normals);
        if (normal) normal.needsUpdate = true;
    }
}

/** Drags of named handles by a pointer: mouse, pen or finger. */
export class PointerDrag {
    #pointer;

    /**
     * `handles` returns pairs of a name and its position in the world, a `Vector3`. `grab`, `drag`, `release` and
     * `hover` are called with the name, `drag` also with the target: the position under the pointer at the handle's
     * depth. `controls`, such as OrbitControls, are disabled during a drag.
     */
    constructor(canvas, camera, { handles, controls = {}, ...listeners }) {
        Object.assign(this, { canvas, camera, handles, controls, listeners });
        this.held = undefined;
        this.hovered = undefined;
        canvas.style.touchAction = "none";
        // Before the listeners of controls on the same element.
        canvas.addEventListener("pointerdown", (event) => this.#down(event), { capture: true });
        canvas.addEventListener("pointermove", (event) => this.#move(event));
        canvas.addEventListener("pointerup", (event) => this.#up(event));
        canvas.addEventListener("pointercancel", (event) => this.#up(event));
    }

    /** Position on the page, pixels. */
    toScreen(position) {
        const { left, top, width, height } = this.canvas.getBoundingClientRect();
        const { x, y } = position.clone().project(this.camera);
        return { x: left + 0.5 * (x + 1) * width, y: top + 0.5 * (1 - y) * height };
    }

    /** Name of the handle at a position on the page, within a finger's size. */
    nearest(x, y) {
        let [best, nearest] = [undefined, GRASP];
        for (const [name, position] of this.handles()) {
            const pixel = this.toScreen(position);
            const distance = Math.hypot(pixel.x - x, pixel.y - y);
            if (distance < nearest) [best, nearest] = [name, distance];
        }
        return best;
    }

    /** Position in the world below a position on the page, at the depth of another position. */
    under(x, y, depthOf) {
        const { left, top, width, height } = this.canvas.getBoundingClientRect();
        const ray = new THREE.Raycaster();
        ray.setFromCamera(new THREE.Vector2((2 * (x - left)) / width - 1, 1 - (2 * (y - top)) / height), this.camera);
        const plane = new THREE.Plane().setFromNormalAndCoplanarPoint(this.camera.getWorldDirection(new THREE.Vector3()), depthOf);
        return ray.ray.intersectPlane(plane, new THREE.Vector3());
    }

    #hover(name) {
        this.canvas.style.cursor = this.held !== undefined ? "grabbing" : name !== undefined ? "grab" : "";
        if (name === this.hovered) return;
        this.hovered = name;
        this.listeners.hover?.(name);
    }

    #down(event) {
        // A second pointer does not affect the first one's drag.
        if (this.held !== undefined) return event.stopImmediatePropagation();
        const name = event.isPrimary && event.button === 0 ? this.nearest(event.clientX, event.clientY) : undefined;
        this.controls.enabled = name === undefined;
        if (name === undefined) return undefined;
        this.canvas.setPointerCapture(event.pointerId);
        this.held = name;
        this.#pointer = event.pointerId;
        this.#hover(name);
        return this.listeners.grab?.(name);
    }

    #move(event) {
        if (this.held === undefined) return event.buttons === 0 && this.#hover(this.nearest(event.clientX, event.clientY));
        if (event.pointerId !== this.#pointer) return undefined;
        const position = [...this.handles()].find(([name]) => name === this.held)?.[1];
        const target = position && this.under(event.clientX, event.clientY, position);
        return target && this.listeners.drag?.(this.held, target);
    }

    #up(event) {
        if (event.pointerId !== this.#pointer) return;
        const name = this.held;
        this.held = this.#pointer = undefined;
        this.controls.enabled = true;
        this.#hover(this.hovered);
        this.listeners.release?.(name);
    }
}
