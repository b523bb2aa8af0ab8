// Meshes that a robot's file names, from the dropped files; for drawing only.
import * as THREE from "three";
import { ColladaLoader } from "three/addons/loaders/ColladaLoader.js";
import { OBJLoader } from "three/addons/loaders/OBJLoader.js";
import { STLLoader } from "three/addons/loaders/STLLoader.js";
import { managerOf } from "./dropped_urls.js";
import { extension } from "./files.js";

export class LinkMeshes {
    #files;
    #loading;
    #read = new Map();

    constructor(files, material) {
        this.#files = files;
        this.material = material;
        this.#loading = managerOf(files);
    }

    /** The object of a mesh file, in the file's own unit. */
    drawn(name) {
        if (!this.#read.has(name)) this.#read.set(name, this.#parse(name));
        return this.#read.get(name).clone();
    }

    /** Frees the textures. */
    forget() {
        this.#loading.forget();
    }

    #parse(name) {
        const bytes = this.#files[name];
        const text = () => new TextDecoder().decode(bytes);
        switch (extension(name)) {
            case "stl": {
                const { buffer, byteOffset, byteLength } = bytes;
                return new THREE.Mesh(new STLLoader().parse(buffer.slice(byteOffset, byteOffset + byteLength)), this.material);
            }
            case "dae": {
                // The file's up axis is ignored: a link's axes are those of its mesh, and the loader does not rotate
                // files with y up.
                const upright = text().replace(/<up_axis>.*?<\/up_axis>/s, "<up_axis>Y_UP</up_axis>");
                const { scene } = new ColladaLoader(this.#loading.manager).parse(upright, "");
                return scene;
            }
            case "obj": {
                const object = new OBJLoader(this.#loading.manager).parse(text());
                object.traverse((part) => (part.isMesh ? (part.material = this.material) : part));
                return object;
            }
            default:
                throw new Error(`${name}: unsupported mesh format, expected .stl, .dae or .obj`);
        }
    }
}
