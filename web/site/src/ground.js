// The ground: its squares, the shadows on it, and the support of a standing body.
import * as THREE from "three";

/** Number of squares along a side. */
const SQUARE_COUNT = 40;
/** Lines that fade with the distance from the middle. */
const LINES = {
    vertexShader: "varying vec2 at; uniform float count; void main() { at = count * (uv - 0.5); gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }",
    fragmentShader: `varying vec2 at; uniform float count;
        void main() {
            vec2 line = abs(fract(at - 0.5) - 0.5) / fwidth(at);
            float fade = pow(max(0.0, 1.0 - 2.0 * length(at) / count), 2.0);
            gl_FragColor = vec4(0.5, 0.55, 0.6, 0.35 * fade * (1.0 - min(min(line.x, line.y), 1.0)));
        }`,
};
/** Colours of the support polygon and of the centre of mass: inside, and outside. */
const [BALANCED, UNBALANCED] = [0x2f9e6e, 0xd9822b];
/** Largest number of corners of a support polygon. */
const MAX_CORNERS = 64;
/** Height of marks above the ground, relative to the size of the scene. */
const RAISED = 0.0015;

/** Squares and shadows; `side` is the side length of a square. */
export class Ground extends THREE.Group {
    constructor(side, up) {
        super();
        const plane = new THREE.PlaneGeometry(SQUARE_COUNT * side, SQUARE_COUNT * side);
        const lines = new THREE.ShaderMaterial({ ...LINES, uniforms: { count: { value: SQUARE_COUNT } }, transparent: true, depthWrite: false, side: THREE.DoubleSide });
        const shadows = new THREE.Mesh(plane, new THREE.ShadowMaterial({ opacity: 0.25, depthWrite: false }));
        shadows.receiveShadow = true;
        this.add(shadows, new THREE.Mesh(plane, lines));
        if (up === "y") this.rotation.x = -Math.PI / 2;
    }
}

/** Support polygon and centre of mass of a standing body, as marks on the ground; z is up. */
export class SupportMarks extends THREE.Group {
    constructor(size) {
        super();
        this.raised = RAISED * size;
        const flat = (color, opacity) => new THREE.MeshBasicMaterial({ color, opacity, transparent: true, side: THREE.DoubleSide, depthWrite: false });
        this.area = new THREE.Mesh(new THREE.BufferGeometry(), flat(BALANCED, 0.3));
        this.area.geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(3 * MAX_CORNERS), 3));
        this.area.geometry.setIndex(Array.from({ length: MAX_CORNERS - 2 }, (_, k) => [0, k + 1, k + 2]).flat());
        this.centre = new THREE.Mesh(new THREE.CircleGeometry(0.008 * size, 24), flat(BALANCED, 0.95));
        this.area.frustumCulled = false;
        this.add(this.area, this.centre);
    }

    /** `polygon` and `centre` have three numbers a point; the polygon is counter-clockwise. */
    show({ polygon, centre }) {
        const { position } = this.area.geometry.attributes;
        position.array.set(polygon);
        position.needsUpdate = true;
        const corners = polygon.length / 3;
        this.area.geometry.setDrawRange(0, 3 * (corners - 2));
        this.area.position.z = this.raised;
        this.centre.position.set(centre[0], centre[1], centre[2] + 2 * this.raised);
        const isInside = Array.from({ length: corners }, (_, k) => k).every((k) => {
            const [x, y, , nextX, nextY] = [...polygon, ...polygon.slice(0, 3)].slice(3 * k);
            return (nextX - x) * (centre[1] - y) - (nextY - y) * (centre[0] - x) >= -1e-4;
        });
        for (const mark of [this.area, this.centre]) mark.material.color.set(isInside ? BALANCED : UNBALANCED);
    }
}
