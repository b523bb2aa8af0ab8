// Selection of a session by the extensions of the files.
import { AnimatedSession } from "./animated_session.js";
import { extension } from "./files.js";
import { RetargetSession } from "./retarget_session.js";
import { RigSession } from "./rig_session.js";
import { RobotSession } from "./robot_session.js";
import { MotionCapture, Rig, Robot, Scene } from "kinopt";

const KINDS = ["urdf", "xml", "glb", "gltf", "bvh", "json"];

/** Opens files `{ name: bytes }`. */
export function openSession(files, options) {
    const names = Object.keys(files);
    const fileOfKind = (kind) => names.find((candidate) => extension(candidate) === kind);
    const name = KINDS.map(fileOfKind).find(Boolean);
    if (!name) throw new Error(`${names.join(", ")}: no model, expected a .urdf, .xml (MJCF), .glb, .gltf, .bvh or .json (rig) file`);
    // Files are dropped without their folders.
    const open = (file) => files[decodeURIComponent(file).split("/").pop()];
    const bytes = files[name];
    switch (extension(name)) {
        case "urdf":
        case "xml": {
            const captureName = fileOfKind("bvh");
            if (!captureName) return new RobotSession((base) => robot(name, bytes, base), names, options);
            const capture = MotionCapture.fromBytes(files[captureName], captureName);
            return new RetargetSession(robot(name, bytes, { baseJoint: "free" }), names, capture);
        }
        case "bvh":
            return new AnimatedSession(MotionCapture.fromBytes(bytes, name), options);
        case "json":
            return new RigSession(Rig.parse(bytes, name, open), options);
        default:
            return new AnimatedSession(Scene.fromBytes(bytes, name, open), options);
    }
}

function robot(name, bytes, options) {
    const text = new TextDecoder().decode(bytes);
    return extension(name) === "urdf" ? Robot.fromUrdf(text, name, options) : Robot.fromMjcf(text, name, options);
}
