// A motion capture on a humanoid robot: retargeted within its limits and saved as a table.
import { readFileSync, writeFileSync } from "node:fs";
import { MotionCapture, retarget, Robot } from "kinopt";

const file = (name) => readFileSync(new URL(`../../models/${name}`, import.meta.url));
const robot = Robot.fromUrdf(file("aldebaran_nao.urdf").toString(), "aldebaran_nao.urdf", { baseJoint: "free" });
const capture = MotionCapture.fromBytes(file("captures/steps.bvh"), "steps.bvh");
const motion = retarget(robot, capture.clip, undefined, { fps: 30 });
const length = robot.model.configurationLen;
console.log(`${motion.times.length} frames of ${length} numbers`);
const { lower, upper } = robot.model;
if (!motion.q.every((value, k) => lower[k % length] <= value && value <= upper[k % length])) process.exitCode = 1;

const rows = Array.from(motion.times, (time, frame) => [time, ...motion.q.slice(length * frame, length * (frame + 1))]);
const out = process.argv[2] ?? "steps.csv";
writeFileSync(out, rows.map((row) => `${row.join(",")}\n`).join(""));
console.log(`saved: ${out}`);
