// A servo at 1 kHz: the tool follows a target that jumps, within velocity, acceleration and jerk limits.
import { Arm, Robot } from "kinopt";
import panda from "kinopt/models/franka_panda.js";

const arm = new Arm(Robot.fromUrdf(panda), "base", "tool");
const start = [0, -0.4, 0, -2, 0, 1.6, 0.8];
const limits = { accelerationLimits: Array(7).fill(10), jerkLimits: Array(7).fill(500) }; // rad/s² and rad/s³
const servo = arm.servo(start, 0.001, limits);
const target = arm.baseFromTool(start); // 4 x 4 by columns: x, y, z are numbers 12, 13, 14
let cycles = 0;
let fastest = 0;
for (const [y, z] of [[0.2, 0.1], [-0.4, 0]]) {
    target[13] += y; // metres
    target[14] += z;
    do {
        servo.step(target);
        cycles += 1;
        fastest = Math.max(fastest, ...servo.acceleration.map(Math.abs));
    } while (!servo.reached);
}
console.log(`${cycles} cycles, at most ${fastest.toFixed(2)} rad/s²`);
if (fastest > 10 * (1 + 1e-9)) process.exitCode = 1;
