// What is drawn of what is open: a skin, bones or a robot's links; the places that are grabbed; what is in the way.
import * as THREE from "three";

const SKIN = 0xb9c3cc;
const BONE = 0xcfa675;
const LINK = 0xd8d5cd;
const BOX = 0xb98a5b;
const FREE = 0x8f9aa3;
const PINNED = 0x1f6fb2;
const GRABBED = 0xe08a1e;
const LIMITED = 0xc8442f;

const solid = (color, more) => new THREE.MeshStandardMaterial({ color, roughness: 0.75, metalness: 0.05, ...more });

export class BodyView {
    constructor(stage, opened) {
        this.stage = stage;
        this.group = new THREE.Group();
        stage.scene.add(this.group);
        this.opened = opened;
        this.count = opened.handles.length;
        if (opened.kind === "robot") this.#links();
        else if (opened.triangles.length > 0) this.#skin();
        else this.#bones();
        stage.frame(this.#extent(), opened.up, opened.from);
        this.#handles();
        this.show(opened);
    }

    #extent() {
        const { positions, places, links, boxes = [] } = this.opened;
        if (positions) return positions;
        if (!links) return places;
        const origins = Array.from({ length: links.length / 16 }, (_, k) => [...links.subarray(16 * k + 12, 16 * k + 15)]);
        return [...origins.flat(), ...boxes.flatMap(({ at }) => at)];
    }

    #skin() {
        this.geometry = new THREE.BufferGeometry();
        this.geometry.setIndex(new THREE.BufferAttribute(this.opened.triangles, 1));
        // What has no normals is lit face by face.
        const flatShading = this.opened.normals.length === 0;
        for (const name of flatShading ? ["position"] : ["position", "normal"]) {
            const numbers = new Float32Array(this.opened.positions.length);
            const attribute = new THREE.BufferAttribute(numbers, 3).setUsage(THREE.DynamicDrawUsage);
            this.geometry.setAttribute(name, attribute);
        }
        const mesh = new THREE.Mesh(this.geometry, solid(SKIN, { transparent: true, opacity: 0.92, side: THREE.DoubleSide, flatShading }));
        mesh.frustumCulled = false;
        this.group.add(mesh);
    }

    #bones() {
        const { parents } = this.opened;
        const pairs = [...parents].flatMap((parent, bone) => (parent < 0 ? [] : [parent, bone]));
        this.geometry = new THREE.BufferGeometry();
        this.geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(3 * this.count), 3));
        this.geometry.setIndex(pairs);
        const lines = new THREE.LineSegments(this.geometry, new THREE.LineBasicMaterial({ color: BONE }));
        lines.frustumCulled = false;
        this.group.add(lines);
    }

    #links() {
        this.links = this.opened.shapes.map((shapes) => {
            const link = new THREE.Group();
            link.matrixAutoUpdate = false;
            for (const shape of shapes) link.add(drawn(shape, LINK));
            this.group.add(link);
            return link;
        });
        for (const { size, at } of this.opened.boxes) {
            const box = new THREE.Mesh(new THREE.BoxGeometry(...size), solid(BOX));
            box.position.set(...at);
            this.group.add(box);
        }
    }

    #handles() {
        const radius = this.opened.kind === "robot" ? 0.02 * this.stage.size : 0.009 * this.stage.size;
        const material = new THREE.MeshBasicMaterial({ depthTest: false, transparent: true, opacity: 0.9 });
        this.balls = new THREE.InstancedMesh(new THREE.SphereGeometry(radius, 12, 8), material, this.count);
        this.balls.renderOrder = 1;
        this.balls.frustumCulled = false;
        this.group.add(this.balls);
        this.mark({ pins: new Set(this.opened.pins) });
    }

    /** Colours the handles. */
    mark({ pins, grabbed, limits = [] }) {
        const color = new THREE.Color();
        this.opened.handles.forEach((name, k) => {
            const limited = limits.some((joint) => joint === name || joint.startsWith(`${name}/`));
            color.set(name === grabbed ? GRABBED : limited ? LIMITED : pins.has(name) ? PINNED : FREE);
            this.balls.setColorAt(k, color);
        });
        this.balls.instanceColor.needsUpdate = true;
        this.stage.touch();
    }

    /** Moves all to what the library answered. */
    show({ positions, normals, places, links }) {
        this.places = places;
        if (this.geometry) {
            const { position, normal } = this.geometry.attributes;
            position.array.set(positions ?? places);
            position.needsUpdate = true;
            if (normal) {
                normal.array.set(normals);
                normal.needsUpdate = true;
            }
        }
        this.links?.forEach((link, k) => {
            link.matrix.fromArray(links, 16 * k);
            link.matrixWorldNeedsUpdate = true;
        });
        const at = new THREE.Matrix4();
        for (let k = 0; k < this.count; k += 1) {
            this.balls.setMatrixAt(k, at.makeTranslation(places[3 * k], places[3 * k + 1], places[3 * k + 2]));
        }
        this.balls.instanceMatrix.needsUpdate = true;
        this.stage.touch();
    }

    /** Where a handle stands. */
    place(name) {
        return new THREE.Vector3().fromArray(this.places, 3 * this.opened.handles.indexOf(name));
    }

    /** The handle next to a pixel, within reach of a finger. */
    nearest(x, y) {
        let best;
        let least = 60;
        for (const name of this.opened.handles) {
            const seen = this.stage.toScreen(this.place(name));
            const away = Math.hypot(seen.x - x, seen.y - y);
            if (away < least) [best, least] = [name, away];
        }
        return best;
    }

    remove() {
        this.stage.scene.remove(this.group);
        this.group.traverse(({ geometry, material }) => {
            geometry?.dispose();
            material?.dispose();
        });
    }
}

/** A body of a link; the library's cylinders and capsules stand along z, three.js's along y. */
function drawn({ kind, size, radius, length, radii, linkFromShape }, color) {
    const geometry = {
        box: () => new THREE.BoxGeometry(...size),
        sphere: () => new THREE.SphereGeometry(radius, 24, 16),
        ellipsoid: () => new THREE.SphereGeometry(1, 24, 16).scale(...radii),
        cylinder: () => new THREE.CylinderGeometry(radius, radius, length, 32).rotateX(Math.PI / 2),
        capsule: () => new THREE.CapsuleGeometry(radius, length, 8, 32).rotateX(Math.PI / 2),
    }[kind]();
    const mesh = new THREE.Mesh(geometry, solid(color));
    mesh.matrixAutoUpdate = false;
    mesh.matrix.fromArray(linkFromShape);
    return mesh;
}
