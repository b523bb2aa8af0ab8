// What a set of files is: told by the extension of one of them.
import { AnimatedSession } from "./animated_session.js";
import { ArmSession } from "./arm_session.js";
import { RigSession } from "./rig_session.js";
import { MotionCapture, Rig, Robot, Scene } from "kinopt";

const KINDS = ["urdf", "glb", "gltf", "bvh", "json"];
const extension = (name) => name.slice(name.lastIndexOf(".") + 1).toLowerCase();

/** Opens files `{ name: bytes }`. */
export function openSession(files, options) {
    const names = Object.keys(files);
    const name = KINDS.map((kind) => names.find((own) => extension(own) === kind)).find(Boolean);
    if (!name) throw new Error(`${names.join(", ")}: a model is a .urdf, .glb, .gltf, .bvh or a rig's .json file`);
    // Files are dropped without their folders.
    const open = (file) => files[decodeURIComponent(file).split("/").pop()];
    const bytes = files[name];
    switch (extension(name)) {
        case "urdf":
            return new ArmSession(Robot.fromUrdf(new TextDecoder().decode(bytes), name), options);
        case "bvh":
            return new AnimatedSession(MotionCapture.fromBytes(bytes, name), options);
        case "json":
            return new RigSession(Rig.parse(bytes, name, open), options);
        default:
            return new AnimatedSession(Scene.fromBytes(bytes, name, open), options);
    }
}
