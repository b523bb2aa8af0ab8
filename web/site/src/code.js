// The JavaScript behind each scene. `bytes`, `text`, `draw` and `follow` are functions of the reader: they read files, draw
// a configuration, and call a function in every frame.

const humanoid = `import { Drag, Problem, Rig, Robot, framePlacement, tasks } from "kinopt";

const parts = { "humanoid.ply": await bytes("humanoid.ply"), "humanoid.dmat": await bytes("humanoid.dmat") };
const rig = Rig.parse(await bytes("humanoid.json"), "humanoid.json", (name) => parts[name]);
const { model } = Robot.ofModel(rig.model, { baseJoint: "free" });
const rest = model.neutral();
const at = (frame) => framePlacement(model, frame, rest);
const feet = ["left_foot/tip", "right_foot/tip"];
const on = Object.fromEntries(feet.map((foot) => [foot, [[0, 0, 0], [-0.18, -0.09, 0]]])); // toe and heel
const drag = new Drag(new Problem(model, [
    ...feet.map((foot) => tasks.pose(foot, at(foot), { level: 0 })),
    tasks.supportPolygon([], { on, masses: rig.masses, level: 1 }),
    tasks.point("left_hand/tip", at("left_hand/tip").slice(12, 15), { name: "hand", level: 2 }),
    tasks.posture(rest, { jointWeights: "upright" }),
]), rest);
follow((hand) => draw(drag.advance({ hand }).q));
`;

const nao = `import { Drag, Problem, Robot, framePlacement, tasks } from "kinopt";

const robot = Robot.fromUrdf(await text("aldebaran_nao.urdf"), "nao.urdf", { baseJoint: "free" });
const feet = ["left_sole", "right_sole"];
const stance = robot.crouchedConfiguration(feet, robot.model.neutral());
const at = (frame) => framePlacement(robot.model, frame, stance);
const on = Object.fromEntries(feet.map((foot) => [foot, robot.sole(foot)]));
const drag = new Drag(new Problem(robot.model, [
    ...feet.map((foot) => tasks.pose(foot, at(foot), { level: 0 })),
    tasks.supportPolygon([], { on, level: 1 }),
    tasks.point("left_hand", at("left_hand").slice(12, 15), { name: "hand", level: 2 }),
    tasks.posture(stance, { jointWeights: "upright" }),
]), stance);
follow((hand) => draw(drag.advance({ hand }).q));
`;

const quadruped = `import { Drag, Problem, Robot, framePlacement, tasks } from "kinopt";

const robot = Robot.fromUrdf(await text("quadruped.urdf"), "quadruped.urdf", { baseJoint: "free" });
const stance = robot.model.neutral(); // legs are bent at zero
const at = (frame) => framePlacement(robot.model, frame, stance).slice(12, 15);
const feet = ["front_left_foot", "front_right_foot", "rear_left_foot", "rear_right_foot"];
const on = Object.fromEntries(feet.map((foot) => [foot, robot.sole(foot)]));
const drag = new Drag(new Problem(robot.model, [
    ...feet.map((foot) => tasks.point(foot, at(foot), { level: 0 })),
    tasks.supportPolygon([], { on, level: 1 }),
    tasks.point("body", at("body"), { name: "body", level: 2 }),
    tasks.posture(stance, { jointWeights: "upright" }),
]), stance);
follow((body) => draw(drag.advance({ body }).q));
`;

const panda = `import { Arm, CollisionModel, Robot, World } from "kinopt";

const robot = Robot.fromUrdf(await text("franka_panda.urdf"));
const world = new World();
world.addBox("table", [0.5, 1.0, 0.04], [0.55, 0, 0.12]);
world.addBox("crate", [0.16, 0.16, 0.3], [0.5, -0.3, 0.29]);
const arm = Arm.keepingClear(robot, "base", "flange", CollisionModel.ofRobot(robot), world, 0.01);
const start = [0, -0.4, 0, -2, 0, 1.6, 0.8];
const follower = arm.follower(start);
const target = arm.baseFromTool(start); // 4 x 4 by columns
follow((position) => {
    target.set(position, 12);
    draw(follower.advance(target).q); // at least 1 cm from boxes and itself
});
`;

const clip = `import { Drag, Problem, Rig, framePlacement, tasks } from "kinopt";

const parts = { "humanoid.ply": await bytes("humanoid.ply"), "humanoid.dmat": await bytes("humanoid.dmat") };
const rig = Rig.parse(await bytes("humanoid.json"), "humanoid.json", (name) => parts[name]);
const { model, clip } = rig;
const at = (tip, q) => framePlacement(model, tip, q).slice(12, 15);
const tips = rig.constrained.map((bone) => rig.skeleton.tip(bone)); // head, hands, feet
const drag = new Drag(new Problem(model, tips.map((name) => tasks.point(name, [0, 0, 0], { name }))), model.neutral());
follow((hand, seconds) => {
    const q = clip.sample(seconds, "loop");
    const targets = Object.fromEntries(tips.map((tip) => [tip, at(tip, q)]));
    drag.setConfiguration(q);
    draw(drag.advance({ ...targets, "left_hand/tip": hand }).q); // the clip, with one hand held
});
`;

const capture = `import { MotionCapture, RetargetFollower, Robot } from "kinopt";

const { clip, armature } = MotionCapture.fromBytes(await bytes("steps.bvh"), "steps.bvh");
const robot = Robot.fromUrdf(await text("aldebaran_nao.urdf"), "nao.urdf", { baseJoint: "free" });
const follower = new RetargetFollower(robot, clip, undefined, { fps: 30 });
follow((_, seconds) => {
    const subject = armature.places(clip.sample(clip.start + seconds, "loop")); // or from a camera
    draw(follower.step(subject)); // within joint limits, without foot sliding
});
`;

export const CODE = { humanoid, nao, quadruped, panda, clip, capture };
