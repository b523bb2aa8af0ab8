// A hand of a character follows a target while head, other hand and feet stay in place. The posed mesh is saved.
import { readFileSync, writeFileSync } from "node:fs";
import { Drag, ForwardKinematics, Problem, Rig, tasks } from "kinopt";

const file = (name) => readFileSync(new URL(`../../models/humanoid/${name}`, import.meta.url));
const rig = Rig.parse(file("humanoid.json"), "humanoid.json", file);
const rest = rig.model.neutral();
const tips = rig.constrained.map((bone) => rig.skeleton.tip(bone));
const at = new ForwardKinematics(rig.model, tips).place(rest).slice(); // 16 numbers for each tip
const points = tips.map((tip, k) => tasks.point(tip, at.slice(16 * k + 12, 16 * k + 15), { name: rig.constrained[k] }));
const drag = new Drag(new Problem(rig.model, points), rest);
const hand = 16 * rig.constrained.indexOf("left_hand") + 12;
for (let step = 1; step <= 30; step += 1) {
    const share = step / 30;
    const target = [0.35, 0.45, 1.5].map((goal, axis) => (1 - share) * at[hand + axis] + share * goal); // metres
    drag.advance({ left_hand: target });
}
const solution = drag.settle();
console.log(solution.explain());
if (!solution.reached) process.exitCode = 1;

const skin = rig.posing("dqs");
skin.deform(solution.q);
const out = process.argv[2] ?? "reaching.json";
writeFileSync(out, JSON.stringify({ positions: Array.from(skin.positions), triangles: Array.from(rig.triangles) }));
console.log(`saved: ${out}`);
