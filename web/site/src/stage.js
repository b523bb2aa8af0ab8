// The scene, its camera, light and ground; draws after changes.
import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

/** Fraction of the distance by which the view follows in a frame. */
const FOLLOW_FRACTION = 0.05;
/** Side length of the shadow map, pixels. */
const SHADOW_PIXELS = 1024;
/** Direction of the main light, and of the light from behind, in front of a figure along x with z up. */
const [MAIN_LIGHT, BACK_LIGHT] = [[1.6, -0.9, 2.6], [-2, 1.6, 1.2]];

export class Stage {
    constructor(canvas) {
        this.canvas = canvas;
        this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
        this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
        this.renderer.shadowMap.enabled = true;
        this.renderer.toneMapping = THREE.NeutralToneMapping;
        this.scene = new THREE.Scene();
        this.#light();
        this.camera = new THREE.PerspectiveCamera(35, 1, 0.01, 100);
        this.orbit = new OrbitControls(this.camera, canvas);
        this.orbit.addEventListener("change", () => this.touch());
        new ResizeObserver(() => this.#resize()).observe(canvas);
        this.#resize();
    }

    #light() {
        this.sky = new THREE.HemisphereLight(0xffffff, 0xb9ad9a, 1.7);
        this.sun = new THREE.DirectionalLight(0xfff3e2, 2.3);
        this.sun.castShadow = true;
        this.sun.shadow.mapSize.set(SHADOW_PIXELS, SHADOW_PIXELS);
        this.sun.shadow.radius = 5;
        this.back = new THREE.DirectionalLight(0xcfe4ff, 1.4);
        this.scene.add(this.sky, this.sun, this.sun.target, this.back, this.back.target);
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
     * enlarges the distance; it is smaller on an upright screen.
     */
    frame(points, { up, from, distanceFactor = this.camera.aspect < 1 ? 1.3 : 1.4 }) {
        const box = new THREE.Box3().setFromArray(points);
        const centre = box.getCenter(new THREE.Vector3());
        const size = Math.max(box.getSize(new THREE.Vector3()).length(), 1e-3);
        this.up = up;
        this.sky.position.set(0, up === "z" ? 0 : 1, up === "z" ? 1 : 0);
        this.camera.up.set(0, up === "z" ? 0 : 1, up === "z" ? 1 : 0);
        const back = new THREE.Vector3(...from).normalize();
        this.camera.position.copy(centre).addScaledVector(back, distanceFactor * this.#fitDistance(points, centre, back));
        this.camera.near = 0.01 * size;
        this.camera.far = 30 * size;
        this.camera.updateProjectionMatrix();
        this.orbit.target.copy(centre);
        this.orbit.update();
        this.size = size;
        this.#aimLights(centre);
        this.touch();
    }

    /** Moves the lights and the area of shadows to a position. */
    #aimLights(centre) {
        const direction = ([x, y, z]) => (this.up === "z" ? new THREE.Vector3(x, y, z) : new THREE.Vector3(y, z, x)).normalize();
        for (const [light, from] of [[this.sun, MAIN_LIGHT], [this.back, BACK_LIGHT]]) {
            light.position.copy(centre).addScaledVector(direction(from), 2 * this.size);
            light.target.position.copy(centre);
        }
        const { camera } = this.sun.shadow;
        const half = 1.1 * this.size;
        Object.assign(camera, { left: -half, right: half, top: half, bottom: -half, near: 0.1 * this.size, far: 5 * this.size });
        camera.updateProjectionMatrix();
        this.sun.shadow.normalBias = 0.002 * this.size;
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
        this.#aimLights(this.orbit.target);
        this.orbit.update();
    }

    /** Position and target of the camera, six numbers. */
    get view() {
        return [...this.camera.position, ...this.orbit.target];
    }

    set view(numbers) {
        this.camera.position.fromArray(numbers);
        this.orbit.target.fromArray(numbers, 3);
        this.orbit.update();
        this.touch();
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
}
