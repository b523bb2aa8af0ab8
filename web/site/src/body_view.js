// Drawing of the opened model: a skin, bones or a robot's links; handles; obstacles; the ground.
import * as THREE from "three";
import { RobotLinks, Skin, shapeMesh } from "kinopt/three";
import { extension } from "./files.js";
import { Ground, SupportMarks } from "./ground.js";
import { StickFigure } from "./stick_figure.js";

const SKIN = 0xd6dbe0;
const BONE = 0xcfa675;
/** Colours of a robot's shapes: the hulls of links, and the joints between. */
const [LINK, JOINT] = [0xe9e6df, 0x4b5661];
const BOX = 0xb98a5b;
/** Side length of the ground's squares relative to the size of the scene. */
const SQUARE_SIDE = 0.2;
/** Radii of handles relative to the size of the model: of joints, and of the ends of a robot's limbs. */
const [JOINT_RADIUS, END_RADIUS] = [0.008, 0.014];
/** Colour of free handles: dark, because skins, sticks and links are light. */
const FREE = 0x46525c;
const PINNED = 0x1f6fb2;
const GRABBED = 0xe08a1e;
const HOVERED = 0x8fa3b3;
const LIMITED = 0xc8442f;
/** Scale of a grabbed handle, because its colour may be that of a pinned one. */
const GRABBED_SCALE = 1.4;

const solid = (color, more) => new THREE.MeshStandardMaterial({ color, roughness: 0.5, metalness: 0.05, ...more });

/** Thickness of sticks relative to the size of a figure. */
const STICK_THICKNESS = 0.012;
const sizeOf = (points) => new THREE.Box3().setFromArray(points).getSize(new THREE.Vector3()).length();

export class BodyView {
    /** `files` are the opened files. */
    constructor(stage, opened, files) {
        this.stage = stage;
        this.group = new THREE.Group();
        stage.scene.add(this.group);
        this.opened = opened;
        this.files = files;
        /** Notes about parts that cannot be drawn, after all delayed parts are loaded. */
        this.dressed = Promise.resolve([]);
        this.count = opened.handles.length;
        if (opened.shapes) this.#links();
        if (opened.triangles?.length > 0) this.#skin();
        else if (opened.parents) this.#bones();
        const extent = this.#extent();
        stage.frame(extent, opened);
        // A walking subject moves the ground in every frame.
        if (opened.kind !== "movement") {
            this.#ground();
            this.grid.position[opened.up] = opened.floor ?? lowest(extent, opened.up);
        }
        if (opened.polygon) this.group.add((this.marks = new SupportMarks(stage.size)));
        this.#handles();
        this.show(opened);
        this.#shadows();
    }

    #shadows() {
        this.group.traverse((part) => {
            if (part.isMesh && part !== this.balls && part.parent !== this.grid && part.parent !== this.marks) part.castShadow = part.receiveShadow = true;
        });
    }

    #extent() {
        const { positions, places, links, person = [] } = this.opened;
        if (positions) return positions;
        if (!links) return places;
        this.#place(links);
        this.group.updateMatrixWorld(true);
        const filled = [...this.links, ...this.boxes].map((part) => new THREE.Box3().setFromObject(part)).filter((box) => !box.isEmpty());
        return [...this.#origins(links), ...person, ...filled.flatMap(corners)];
    }

    /** Origins of the links, three numbers each. */
    #origins(links) {
        return Array.from({ length: links.length / 16 }, (_, k) => [...links.subarray(16 * k + 12, 16 * k + 15)]).flat();
    }

    #skin() {
        const { triangles, positions, normals } = this.opened;
        const plain = solid(SKIN, { side: THREE.DoubleSide });
        this.skin = new Skin(triangles, positions, normals, plain);
        this.geometry = this.skin.geometry;
        this.group.add(this.skin);
        if (Object.keys(this.files).some((name) => ["glb", "gltf"].includes(extension(name)))) this.dressed = this.#dress(plain);
    }

    /** Materials of a scene, once they are loaded; without them it is plain. */
    async #dress(plain) {
        const { positions, triangles } = this.opened;
        const { sceneLook } = await import("./scene_look.js");
        const look = await sceneLook(this.files, positions.length / 3, triangles.length).catch(() => undefined);
        if (!look) return [];
        this.geometry.setAttribute("uv", new THREE.BufferAttribute(look.uv, 2));
        for (const { start, count, materialIndex } of look.groups) this.geometry.addGroup(start, count, materialIndex);
        const { flatShading } = plain;
        this.skin.material = look.materials.map((material) => Object.assign(material ?? plain, { flatShading }));
        this.stage.touch();
        return [];
    }

    #bones() {
        const size = sizeOf(this.opened.person ?? this.opened.places);
        this.sticks = new StickFigure(this.opened.parents, STICK_THICKNESS * size, solid(BONE));
        this.group.add(this.sticks.sticks);
    }

    #links() {
        const meshes = [];
        const { bodies, parents } = this.opened.gaps ?? {};
        // Every other link has the colour of joints.
        const depth = (k) => (parents?.[bodies[k]] >= 0 ? 1 + depth(parents[bodies[k]]) : 0);
        const link = solid(LINK);
        // Behind hulls with the same surface.
        const joint = solid(JOINT, { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
        const robot = new RobotLinks(this.opened.shapes, (shape, k) => {
            if (shape.kind !== "mesh") return shapeMesh(shape, shape.kind === "sphere" && depth(k) % 2 === 1 ? joint : link);
            const body = new THREE.Group();
            meshes.push([shape.file, body]);
            return body;
        });
        this.robot = robot;
        this.links = robot.children;
        this.group.add(robot);
        if (meshes.length > 0) this.dressed = this.#fill(meshes);
        const sticks = this.opened.sticks ?? this.#gaps();
        if (sticks) {
            this.limbs = new StickFigure(sticks, STICK_THICKNESS * sizeOf(this.#origins(this.opened.links)), solid(JOINT));
            this.group.add(this.limbs.sticks);
        }
        this.boxes = this.opened.boxes.map(({ size, at }) => {
            const box = new THREE.Mesh(new THREE.BoxGeometry(...size), solid(BOX, { roughness: 0.8 }));
            box.position.set(...at);
            this.group.add(box);
            return box;
        });
    }

    /** Bodies in the gaps between plain shapes that do not meet, each with its parent body. */
    #gaps() {
        const { gaps, links } = this.opened;
        if (!gaps) return undefined;
        const { bodies, parents } = gaps;
        this.#place(links);
        this.group.updateMatrixWorld(true);
        const boxes = bodies.map(() => new THREE.Box3());
        this.links.forEach((link, k) => boxes[bodies[k]].union(new THREE.Box3().setFromObject(link, true)));
        const crossed = parents.map(() => -1);
        boxes.forEach((box, k) => {
            if (box.isEmpty()) return;
            const chain = [k];
            while (parents[chain[0]] >= 0 && (chain.length === 1 || boxes[chain[0]].isEmpty())) chain.unshift(parents[chain[0]]);
            const [end, ...between] = chain;
            if (!boxes[end].isEmpty() && !boxes[end].intersectsBox(box)) for (const body of between) crossed[body] = parents[body];
        });
        return crossed.some((parent) => parent >= 0) ? crossed : undefined;
    }

    /** Loads mesh files, `[file, parent]`. */
    async #fill(meshes) {
        const { LinkMeshes } = await import("./link_meshes.js");
        const drawing = new LinkMeshes(this.files, solid(LINK));
        this.drawing = drawing;
        const notes = new Set();
        for (const [file, body] of meshes) {
            try {
                body.add(drawing.drawn(file));
            } catch (error) {
                notes.add(`${file}: ${error.message}`);
            }
        }
        this.#shadows();
        this.stage.touch();
        return [...notes];
    }

    #handles() {
        const radius = JOINT_RADIUS * this.stage.size;
        const material = new THREE.MeshBasicMaterial({ depthTest: false, transparent: true, opacity: 0.8, toneMapped: false });
        this.balls = new THREE.InstancedMesh(new THREE.SphereGeometry(radius, 16, 10), material, this.count);
        this.balls.renderOrder = 1;
        this.balls.frustumCulled = false;
        this.balls.visible = this.count > 0;
        this.group.add(this.balls);
        this.mark({ pins: new Set(this.opened.pins) });
    }

    /** Colours the handles. A pinned handle stays blue when it is grabbed, so grabbed handles are larger. */
    mark({ pins, grabbed, hovered, limits = [] }) {
        this.grabbed = grabbed;
        this.#spread();
        const color = new THREE.Color();
        this.opened.handles.forEach((name, k) => {
            const limited = limits.some((joint) => joint === name || joint.startsWith(`${name}/`));
            const isGrabbed = name === grabbed;
            color.set(limited && !isGrabbed ? LIMITED : pins.has(name) ? PINNED : isGrabbed ? GRABBED : name === hovered ? HOVERED : FREE);
            this.balls.setColorAt(k, color);
        });
        if (this.count > 0) this.balls.instanceColor.needsUpdate = true;
        this.stage.touch();
    }

    /** Updates the drawing to a result of the library. */
    show(result) {
        const { positions, normals, places, person, links, ground, base } = result;
        this.places = places;
        this.person = person;
        this.sticks?.show(person ?? places);
        this.skin?.update(positions, normals);
        if (base) {
            const [x, y, z, w, qx, qy, qz] = base;
            this.skin.position.set(x, y, z);
            this.skin.quaternion.set(qx, qy, qz, w);
        }
        if (links) this.#place(links);
        this.support = result.polygon && { centre: result.centre, polygon: result.polygon };
        if (this.support) this.marks?.show(this.support);
        this.#spread();
        if (ground) this.#walk(ground);
        this.stage.touch();
    }

    /** Moves the handles to their positions. */
    #spread() {
        const { handles, ends } = this.opened;
        const positions = this.places ?? this.opened.places;
        const matrix = new THREE.Matrix4();
        for (let k = 0; k < this.count; k += 1) {
            const size = (k < ends ? END_RADIUS / JOINT_RADIUS : 1) * (handles[k] === this.grabbed ? GRABBED_SCALE : 1);
            this.balls.setMatrixAt(k, matrix.makeScale(size, size, size).setPosition(positions[3 * k], positions[3 * k + 1], positions[3 * k + 2]));
        }
        this.balls.instanceMatrix.needsUpdate = true;
    }

    #place(links) {
        this.limbs?.show(this.#origins(links));
        this.robot.place(links);
    }

    /** Moves the view with a walking subject, and the ground by whole squares. */
    #walk([x, y]) {
        const side = SQUARE_SIDE * this.stage.size;
        if (!this.grid) this.#ground();
        this.grid.position.set(side * Math.round(x / side), side * Math.round(y / side), 0);
        this.stage.follow(x, y);
    }

    #ground() {
        this.grid = new Ground(SQUARE_SIDE * this.stage.size, this.opened.up);
        this.group.add(this.grid);
    }

    /** Pairs of the handles' names and positions. */
    *handles() {
        for (const name of this.opened.handles) yield [name, this.place(name)];
    }

    /** Position of a handle. */
    place(name) {
        return new THREE.Vector3().fromArray(this.places, 3 * this.opened.handles.indexOf(name));
    }

    remove() {
        this.drawing?.forget();
        this.stage.scene.remove(this.group);
        this.group.traverse(({ geometry, material }) => {
            geometry?.dispose();
            for (const drawnMaterial of [material ?? []].flat()) {
                drawnMaterial.map?.dispose();
                drawnMaterial.dispose();
            }
        });
    }
}

/** Height of the lowest of these points, three numbers each. */
function lowest(points, up) {
    let minHeight = Infinity;
    for (let k = up === "z" ? 2 : 1; k < points.length; k += 3) minHeight = Math.min(minHeight, points[k]);
    return minHeight;
}

/** Corners of a box, three numbers each. */
const corners = ({ min, max }) =>
    [min.x, max.x].flatMap((x) => [min.y, max.y].flatMap((y) => [min.z, max.z].map((z) => [x, y, z]))).flat();
