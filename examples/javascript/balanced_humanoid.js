// A humanoid robot crouches and reaches down, its feet in place and its centre of mass over them.
import { readFileSync } from "node:fs";
import { Drag, framePlacement, Problem, Robot, tasks } from "kinopt";

const urdf = readFileSync(new URL("../../models/aldebaran_nao.urdf", import.meta.url), "utf8");
const robot = Robot.fromUrdf(urdf, "aldebaran_nao.urdf", { baseJoint: "free" });
const feet = ["left_sole", "right_sole"];
const stance = robot.crouchedConfiguration(feet, robot.model.neutral());
const at = (frame) => framePlacement(robot.model, frame, stance);
const [x, y, z] = at("left_hand").slice(12, 15);
const soles = Object.fromEntries(feet.map((foot) => [foot, robot.sole(foot)]));
const problem = new Problem(robot.model, [
    tasks.point("left_hand", [x, y, z], { name: "hand" }),
    ...feet.map((foot) => tasks.pose(foot, at(foot), { scale: 10 })),
    tasks.supportPolygon([], { on: soles, margin: 0.02, scale: 10 }),
    tasks.posture(stance, { jointWeights: "upright" }),
]);
const drag = new Drag(problem, stance); // each frame continues from the last one, without jumps
for (let step = 1; step <= 30; step += 1) {
    const share = step / 30;
    drag.advance({ hand: [x + 0.1 * share, y, z - 0.2 * share] }); // metres
}
const solution = drag.settle();
console.log(solution.explain());
if (!solution.reached) process.exitCode = 1;
