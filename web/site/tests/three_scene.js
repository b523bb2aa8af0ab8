// Result of three.js for a file's bytes; bundled for the browser by three_round_trip.test.js.
import * as THREE from "three";
import { GLTFExporter } from "three/addons/exporters/GLTFExporter.js";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

/** A scene at a time of a clip; at rest without a clip. */
async function posed(bytes, clip, seconds) {
    const { scene, animations } = await new GLTFLoader().parseAsync(Uint8Array.from(bytes).buffer, "");
    if (clip) {
        const mixer = new THREE.AnimationMixer(scene);
        mixer.clipAction(animations.find(({ name }) => name === clip)).setLoop(THREE.LoopOnce).play().clampWhenFinished = true;
        mixer.setTime(seconds);
    }
    scene.updateMatrixWorld(true);
    return { scene, animations };
}

/** Placements of nodes by name, sixteen numbers each. */
export async function placements(bytes, clip, seconds) {
    const { scene } = await posed(bytes, clip, seconds);
    const found = {};
    scene.traverse((node) => (found[node.name] = [...node.matrixWorld.elements]));
    return found;
}

/** Picture of 96 by 96 pixels, four numbers each, of the scene from the front. */
export async function picture(bytes, clip, seconds) {
    const { scene } = await posed(bytes, clip, seconds);
    const renderer = new THREE.WebGLRenderer({ preserveDrawingBuffer: true });
    renderer.setSize(96, 96);
    const camera = new THREE.OrthographicCamera(-2.5, 2.5, 3.5, -1.5, 0.1, 20);
    camera.position.set(0, 0, 5);
    const stage = new THREE.Scene().add(scene, new THREE.AmbientLight(0xffffff, 3));
    renderer.render(stage, camera);
    const gl = renderer.getContext();
    const points = new Uint8Array(4 * 96 * 96);
    gl.readPixels(0, 0, 96, 96, gl.RGBA, gl.UNSIGNED_BYTE, points);
    renderer.dispose();
    return [...points];
}

/** The scene as a .glb written by three.js. */
export async function written(bytes) {
    const { scene, animations } = await posed(bytes);
    return [...new Uint8Array(await new GLTFExporter().parseAsync(scene, { binary: true, animations }))];
}
