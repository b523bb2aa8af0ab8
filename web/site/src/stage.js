// The scene, its camera and its light; draws after changes.
import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

/** Fraction of the distance by which the view follows in a frame. */
const FOLLOW_FRACTION = 0.05;

export class Stage {
    constructor(canvas) {
        this.canvas = canvas;
        this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
        this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
        this.scene = new THREE.Scene();
        this.scene.add(new THREE.HemisphereLight(0xffffff, 0x8a8375, 2.2));
        const sun = new THREE.DirectionalLight(0xffffff, 2.2);
        sun.position.set(2, -3, 5);
        this.scene.add(sun);
        this.camera = new THREE.PerspectiveCamera(35, 1, 0.01, 100);
        this.orbit = new OrbitControls(this.camera, canvas);
        this.orbit.addEventListener("change", () => this.touch());
        new ResizeObserver(() => this.#resize()).observe(canvas);
        this.#resize();
    }

    /** Requests a new picture. */
    touch() {
        if (this.renderRequest) return;
        this.renderRequest = requestAnimationFrame(() => {
            this.renderRequest = undefined;
            this.renderer.render(this.scene, this.camera);
        });
    }

    #resize() {
        const { clientWidth: width, clientHeight: height } = this.canvas;
        if (width === 0 || height === 0) return;
        this.renderer.setSize(width, height, false);
        this.camera.aspect = width / height;
        this.camera.updateProjectionMatrix();
        this.touch();
    }

    /**
     * Moves the camera to show all points, three numbers each, from a direction in front of the figure. A factor
     * enlarges the distance; it is smaller on an upright screen, which is narrow.
     */
    frame(points, { up, from, distanceFactor = this.camera.aspect < 1 ? 1.2 : 1.4 }) {
        const box = new THREE.Box3().setFromArray(points);
        const centre = box.getCenter(new THREE.Vector3());
        const size = Math.max(box.getSize(new THREE.Vector3()).length(), 1e-3);
        this.camera.up.set(0, up === "z" ? 0 : 1, up === "z" ? 1 : 0);
        const back = new THREE.Vector3(...from).normalize();
        this.camera.position.copy(centre).addScaledVector(back, distanceFactor * this.#fitDistance(points, centre, back));
        this.camera.near = 0.01 * size;
        this.camera.far = 30 * size;
        this.camera.updateProjectionMatrix();
        this.orbit.target.copy(centre);
        this.orbit.update();
        this.size = size;
        this.touch();
    }

    /** Distance from `centre` at which all points are visible. */
    #fitDistance(points, centre, back) {
        const high = Math.tan(0.5 * THREE.MathUtils.degToRad(this.camera.fov));
        const wide = high * this.camera.aspect;
        const right = new THREE.Vector3().crossVectors(this.camera.up, back).normalize();
        const above = new THREE.Vector3().crossVectors(back, right);
        const point = new THREE.Vector3();
        let distance = 1e-3;
        for (let k = 0; k < points.length; k += 3) {
            point.fromArray(points, k).sub(centre);
            const offset = Math.max(Math.abs(point.dot(right)) / wide, Math.abs(point.dot(above)) / high);
            distance = Math.max(distance, point.dot(back) + offset);
        }
        return distance;
    }

    /** Follows a walking subject at x and y smoothly. */
    follow(x, y) {
        const step = new THREE.Vector3(x - this.orbit.target.x, y - this.orbit.target.y, 0).multiplyScalar(FOLLOW_FRACTION);
        this.orbit.target.add(step);
        this.camera.position.add(step);
        this.orbit.update();
    }

    /** Rotates the view about its target, radians: to the right and up, not over the top. */
    turn(right, up) {
        const back = this.camera.position.clone().sub(this.orbit.target).applyAxisAngle(this.camera.up, right);
        const axis = new THREE.Vector3().crossVectors(this.camera.up, back).normalize();
        const from = back.angleTo(this.camera.up);
        back.applyAxisAngle(axis, THREE.MathUtils.clamp(from - up, 0.05, Math.PI - 0.05) - from);
        this.#stand(back);
    }

    /** Divides the camera's distance by `times`. */
    nearer(times) {
        this.#stand(this.camera.position.clone().sub(this.orbit.target).divideScalar(times));
    }

    #stand(back) {
        this.camera.position.copy(this.orbit.target).add(back);
        this.orbit.update();
        this.touch();
    }

    /** Position on the page, in pixels. */
    toScreen(position) {
        const { left, top, width, height } = this.canvas.getBoundingClientRect();
        const projected = position.clone().project(this.camera);
        return { x: left + 0.5 * (projected.x + 1) * width, y: top + 0.5 * (1 - projected.y) * height };
    }

    /** Position under the pointer at the depth of another position. */
    under(x, y, depthOf) {
        const { left, top, width, height } = this.canvas.getBoundingClientRect();
        const pointer = new THREE.Vector2((2 * (x - left)) / width - 1, 1 - (2 * (y - top)) / height);
        const ray = new THREE.Raycaster();
        ray.setFromCamera(pointer, this.camera);
        const facing = this.camera.getWorldDirection(new THREE.Vector3());
        const plane = new THREE.Plane().setFromNormalAndCoplanarPoint(facing, depthOf);
        return ray.ray.intersectPlane(plane, new THREE.Vector3());
    }
}
