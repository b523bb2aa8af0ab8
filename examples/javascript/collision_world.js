// An arm among boxes: poses at least 2 cm away from all obstacles, and a world that changes.
import { Arm, CollisionModel, Robot, World } from "kinopt";
import panda from "kinopt/models/franka_panda.js";

const world = new World();
world.addBox("table", [0.8, 1.2, 0.04], [0.65, 0, 0.1]); // metres
world.addBox("shelf", [0.2, 0.6, 0.02], [0.75, 0, 0.5]);
world.addCylinder("pillar", 0.05, 0.8, [0.4, 0.35, 0.5]);
const robot = Robot.fromUrdf(panda);
const arm = Arm.keepingClear(robot, "base", "tool", CollisionModel.ofRobot(robot), world, 0.02);
const start = [0, -0.4, 0, -2, 0, 1.6, 0.8];
const target = [1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0, 0.5, 0.1, 0.2, 1]; // by columns; the tool points down
const solution = arm.solve(target, start);
console.log(solution.explain());

world.addSphere("ball", 0.1, [0.5, 0.1, 0.2]);
const blocked = arm.withWorld(world).solve(target, start);
console.log(blocked.explain());
if (!solution.reached || blocked.reached) process.exitCode = 1;
