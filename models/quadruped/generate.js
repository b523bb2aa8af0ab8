// Writes quadruped.urdf: a robot dog of 12 leg joints and 2 neck joints, about 9 kg. `node models/quadruped/generate.js`
//
// Dimensions and masses are this project's own. At zero the legs are bent, because straight knees are singular.
import { writeFileSync } from "node:fs";

/** Lengths of thigh and shin, half distances of the hips along and across, metres. */
const [THIGH, SHIN, ALONG, ACROSS, HIP] = [0.2, 0.2, 0.18, 0.06, 0.07];
/** Bend of a thigh from the vertical at zero, radians; the shin is bent by twice as much. */
const BEND = 0.7;

const number = (value) => String(Number(value.toFixed(6)));
const list = (values) => values.map(number).join(" ");
const origin = (xyz, rpy = [0, 0, 0]) => `<origin xyz="${list(xyz)}" rpy="${list(rpy)}"/>`;

function shape([kind, at, ...size]) {
    const geometry = {
        box: () => `<box size="${list(size)}"/>`,
        sphere: () => `<sphere radius="${number(size[0])}"/>`,
        cylinder: () => `<cylinder radius="${number(size[0])}" length="${number(size[1])}"/>`,
    }[kind]();
    return ["visual", "collision"].map((use) => `    <${use}>${origin(at)}<geometry>${geometry}</geometry></${use}>`).join("\n");
}

/** A capsule down from the origin. */
const capsule = (radius, length) => [["cylinder", [0, 0, -length / 2], radius, length], ["sphere", [0, 0, 0], radius], ["sphere", [0, 0, -length], radius]];

function link(name, mass, centre, shapes) {
    // Inertia of a ball of 5 cm: statics ignore it.
    const inertia = number(0.4 * mass * 0.05 ** 2);
    const inertial = mass > 0 ? `    <inertial>${origin(centre)}<mass value="${number(mass)}"/><inertia ixx="${inertia}" ixy="0" ixz="0" iyy="${inertia}" iyz="0" izz="${inertia}"/></inertial>\n` : "";
    return `  <link name="${name}">\n${inertial}${shapes.map(shape).join("\n")}\n  </link>`;
}

function joint(name, parent, child, xyz, axis, [lower, upper], rpy) {
    return `  <joint name="${name}" type="revolute">\n    <parent link="${parent}"/><child link="${child}"/>${origin(xyz, rpy)}<axis xyz="${list(axis)}"/>\n` +
        `    <limit lower="${number(lower)}" upper="${number(upper)}" velocity="20" effort="25"/>\n  </joint>`;
}

const fixed = (name, parent, child, xyz) => `  <joint name="${name}" type="fixed">\n    <parent link="${parent}"/><child link="${child}"/>${origin(xyz)}\n  </joint>`;

const [X, Y, Z] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
const parts = [
    link("body", 5, [0, 0, 0], [["box", [0, 0, 0.01], 0.3, 0.13, 0.09], ["box", [0.16, 0, 0], 0.08, 0.11, 0.07], ["box", [-0.16, 0, 0], 0.08, 0.11, 0.07]]),
    joint("neck_yaw", "body", "neck", [0.19, 0, 0.04], Z, [-0.8, 0.8]),
    link("neck", 0.2, [0.02, 0, 0.02], [["sphere", [0, 0, 0], 0.035], ["sphere", [0.02, 0, 0.03], 0.032]]),
    joint("head_pitch", "neck", "head", [0.04, 0, 0.06], Y, [-0.7, 0.7]),
    link("head", 0.5, [0.04, 0, 0], [["box", [0.045, 0, 0], 0.1, 0.075, 0.06], ["box", [0.115, 0, -0.012], 0.05, 0.05, 0.035]]),
];
for (const [end, x] of [["front", 1], ["rear", -1]]) {
    for (const [side, y] of [["left", 1], ["right", -1]]) {
        const leg = `${end}_${side}`;
        parts.push(
            joint(`${leg}_hip_roll`, "body", `${leg}_hip`, [x * ALONG, y * ACROSS, 0], X, [-0.7, 0.7]),
            link(`${leg}_hip`, 0.35, [0, 0.5 * y * HIP, 0], [["sphere", [0, 0.5 * y * HIP, 0], 0.04]]),
            joint(`${leg}_hip_pitch`, `${leg}_hip`, `${leg}_thigh`, [0, y * HIP, 0], Y, [-1.2, 1.2], [0, BEND, 0]),
            link(`${leg}_thigh`, 0.45, [0, 0, -THIGH / 3], capsule(0.028, THIGH)),
            joint(`${leg}_knee`, `${leg}_thigh`, `${leg}_shin`, [0, 0, -THIGH], Y, [-1, 1.3], [0, -2 * BEND, 0]),
            link(`${leg}_shin`, 0.15, [0, 0, -SHIN / 3], capsule(0.018, SHIN)),
            fixed(`${leg}_ankle`, `${leg}_shin`, `${leg}_foot`, [0, 0, -SHIN]),
            link(`${leg}_foot`, 0, [0, 0, 0], [["sphere", [0, 0, 0], 0.024]]),
        );
    }
}
const head = "<!-- A robot dog of 12 leg joints and 2 neck joints. Written by models/quadruped/generate.js. -->";
writeFileSync(new URL("quadruped.urdf", import.meta.url), `<?xml version="1.0"?>\n${head}\n<robot name="quadruped">\n${parts.join("\n")}\n</robot>\n`);
