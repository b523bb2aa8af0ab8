// The humanoid of the project's models.
import { readFileSync } from "node:fs";
import { ForwardKinematics, Rig, tasks } from "kinopt";
import { model } from "./panda.js";

export const humanoid = () =>
    Rig.parse(readFileSync(model("humanoid/humanoid.json")), "humanoid.json", (file) => readFileSync(model(`humanoid/${file}`)));

/** The rig's pins, as tasks at their current positions. */
export function pinned(rig, q) {
    const frames = rig.constrained.map((bone) => rig.skeleton.tip(bone));
    const at = new ForwardKinematics(rig.model, frames).place(q).slice();
    const positionOf = (k) => at.slice(16 * k + 12, 16 * k + 15);
    return rig.constrained.map((name, k) => tasks.point(frames[k], positionOf(k), { name }));
}
