// Pick and place: straight lines through key placements, as a joint path without reconfigurations.
import { Arm, CartesianPath, Robot, solvePath } from "kinopt";
import panda from "kinopt/models/franka_panda.js";

const arm = new Arm(Robot.fromUrdf(panda), "base", "tool");
const at = (x, y, z) => [1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0, x, y, z, 1]; // 4 x 4 by columns; the tool points down
const home = at(0.4, 0, 0.5); // metres
const [overPick, pick] = [at(0.5, -0.3, 0.3), at(0.5, -0.3, 0.1)];
const [overPlace, place] = [at(0.5, 0.3, 0.3), at(0.5, 0.3, 0.1)];

const keys = [overPick, pick, overPick, overPlace, place, overPlace, home];
const path = new CartesianPath(home).through(keys.flat());
const joints = solvePath(arm, path);
console.log(`${joints.jumps.length} reconfigurations, ${joints.report.length.toFixed(2)} rad`);
if (!joints.reached || joints.jumps.length > 0) process.exitCode = 1;
