// Pick and place: straight lines through key positions, as a joint path without reconfigurations.
import { Arm, Robot, solvePath } from "kinopt";
import panda from "kinopt/models/franka_panda.js";

const arm = new Arm(Robot.fromUrdf(panda), "base", "tool");
const home = [0.4, 0, 0.5]; // metres
const [overPick, pick] = [[0.5, -0.3, 0.3], [0.5, -0.3, 0.1]];
const [overPlace, place] = [[0.5, 0.3, 0.3], [0.5, 0.3, 0.1]];
const keys = [home, overPick, pick, overPick, overPlace, place, overPlace, home];

const points = [];
for (let k = 1; k < keys.length; k += 1) {
    for (let step = 0; step < 50; step += 1) {
        const [x, y, z] = keys[k].map((end, axis) => keys[k - 1][axis] + (step / 50) * (end - keys[k - 1][axis]));
        points.push(1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0, x, y, z, 1); // 4 x 4 by columns; the tool points down
    }
}
const path = solvePath(arm, points);
console.log(`${points.length / 16} points, ${path.jumps.length} reconfigurations, ${path.report.length.toFixed(2)} rad`);
if (!path.reached || path.jumps.length > 0) process.exitCode = 1;
