// Writes steps.bvh, a hand-made movement: a person steps aside and back, crouches with arms ahead, and waves.
// Run `node models/captures/generate.js`. The six seconds end as they begin. Centimetres; y up, z ahead, left at +x.
import { writeFileSync } from "node:fs";

const RATE = 30;
const SECONDS = 6;
const [THIGH, SHIN, ANKLE, HIP] = [43, 42, 8, 9];
const TURNS = "CHANNELS 3 Zrotation Xrotation Yrotation";

// Rotation matrices by rows. A joint rotates in the order z, x, y.
const multiply = (a, b) => a.map((row) => b[0].map((_, k) => row.reduce((sum, value, j) => sum + value * b[j][k], 0)));
const transpose = (a) => a[0].map((_, k) => a.map((row) => row[k]));
const about = {
    x: (angle) => [[1, 0, 0], [0, Math.cos(angle), -Math.sin(angle)], [0, Math.sin(angle), Math.cos(angle)]],
    y: (angle) => [[Math.cos(angle), 0, Math.sin(angle)], [0, 1, 0], [-Math.sin(angle), 0, Math.cos(angle)]],
    z: (angle) => [[Math.cos(angle), -Math.sin(angle), 0], [Math.sin(angle), Math.cos(angle), 0], [0, 0, 1]],
};
const degrees = (radians) => (180 * radians) / Math.PI;
const radians = (angle) => (Math.PI * angle) / 180;
const turned = (z, x, y) => [about.z(radians(z)), about.x(radians(x)), about.y(radians(y))].reduce(multiply);
const angles = (m) => [Math.atan2(-m[0][1], m[1][1]), Math.asin(m[2][1]), Math.atan2(-m[2][0], m[2][2])].map(degrees);

/** Smooth interpolation of keys `[seconds, value]`. */
const keyed = (...keys) => (time) => {
    const next = keys.findIndex(([at]) => at > time);
    if (next === 0) return keys[0][1];
    if (next < 0) return keys.at(-1)[1];
    const [[from, before], [to, after]] = [keys[next - 1], keys[next]];
    const share = (time - from) / (to - from);
    return before + (after - before) * share * share * (3 - 2 * share);
};
/** Lateral position of a foot, and its height during each step, centimetres. */
const foot = (x, steps) => ({
    x: keyed([0, x], ...steps.flatMap(([from, to, [before, after]]) => [[from, before], [to, after]])),
    height: keyed([0, 0], ...steps.flatMap(([from, to]) => [[from, 0], [(from + to) / 2, 9], [to, 0]])),
});

const feet = {
    Left: foot(17, [[0.9, 1.4, [17, -3]], [1.6, 2.1, [-3, 17]]]),
    Right: foot(-17, [[0.2, 0.7, [-17, -37]], [2.3, 2.8, [-37, -17]]]),
};
const hips = {
    x: keyed([0, 0], [0.25, 8], [0.9, -24], [1.45, -20], [1.6, -24], [2.25, 7], [2.9, 0], [4.4, 0], [4.9, 4], [5.5, 4], [6, 0]),
    y: keyed([0, 95], [0.25, 92], [0.8, 87], [1.45, 94], [2.2, 88], [2.9, 95], [3.5, 68], [3.8, 68], [4.4, 95], [6, 95]),
    z: keyed([0, 0], [2.9, 0], [3.5, -9], [3.8, -9], [4.4, 0]),
    pitch: keyed([0, 0], [2.9, 0], [3.5, 18], [3.8, 18], [4.4, 0]),
    yaw: keyed([0, 0], [0.7, -10], [1.5, 0], [2.1, 10], [2.8, 0], [4.4, 0], [4.9, 8], [5.5, 8], [6, 0]),
};
const arms = {
    /** Angles of an arm from the side of the body, and ahead, degrees. */
    aside: keyed([0, 12], [0.7, 35], [1.5, 12], [2.1, 35], [2.9, 12]),
    ahead: keyed([0, 0], [2.9, 0], [3.5, 85], [3.8, 85], [4.4, 0]),
    /** Fraction of the raise of the right hand, from 0 to 1. */
    wave: keyed([0, 0], [4.2, 0], [4.8, 1], [5.5, 1], [6, 0]),
};

/** Rotations of a leg's joints, from hips to toes, that bring the ankle to its position and keep the foot level; degrees. */
function leg(side, time, centre, pelvis) {
    const { x, height } = feet[side];
    const hip = multiply(pelvis, [[side === "Left" ? HIP : -HIP], [-4], [0]]).map(([value], k) => value + centre[k]);
    const away = [[x(time) - hip[0]], [ANKLE + height(time) - hip[1]], [-hip[2]]];
    const [right, up, ahead] = multiply(transpose(pelvis), away).map(([value]) => value);
    const long = Math.min(Math.hypot(right, up, ahead), THIGH + SHIN - 0.01);
    const within = (cosine) => Math.acos(Math.min(1, Math.max(-1, cosine)));
    const thigh = within((THIGH ** 2 + long ** 2 - SHIN ** 2) / (2 * THIGH * long));
    const knee = Math.PI - within((THIGH ** 2 + SHIN ** 2 - long ** 2) / (2 * THIGH * SHIN));
    const [swing, pitch] = [Math.atan2(right, -up), -Math.asin(ahead / long) - thigh];
    const shin = [pelvis, about.z(swing), about.x(pitch), about.x(knee)].reduce(multiply);
    return [[degrees(swing), degrees(pitch), 0], [0, degrees(knee), 0], angles(transpose(shin)), [0, 0, 0]];
}

/** Rotations of collar, upper arm, forearm and hand, degrees. At rest the arms point straight sideways. */
function arm(side, time) {
    const sign = side === "Left" ? 1 : -1;
    const wave = side === "Right" ? arms.wave(time) : 0;
    const down = multiply(about.x(radians(-arms.ahead(time))), about.z(sign * radians(arms.aside(time) - 90)));
    const [z, x, y] = angles(down);
    const upper = [z * (1 - wave) + 25 * sign * wave, x * (1 - wave), y * (1 - wave)];
    const swing = 22 * Math.sin(2 * Math.PI * 2 * (time - 4.8));
    return [[0, 0, 0], upper, [sign * wave * (75 + swing), 0, -sign * (1 - wave) * 20], [0, 0, 0]];
}

function frame(time) {
    const centre = [hips.x(time), hips.y(time), hips.z(time)];
    const own = [0, hips.pitch(time), hips.yaw(time)];
    const pelvis = turned(...own);
    const lean = -0.4 * hips.yaw(time);
    const back = [[0, 0.3 * hips.pitch(time), 0], [lean * 0.3, 0, lean], [0, 0, 0], [0, -0.8 * hips.pitch(time), 0]];
    const limbs = [...leg("Left", time, centre, pelvis), ...leg("Right", time, centre, pelvis)];
    return [...centre, ...own, ...[...limbs, ...back, ...arm("Left", time), ...arm("Right", time)].flat()];
}

/** Nested joints from `[name, x, y, z]`; the last one has an end site. */
const chain = ([[name, ...offset], ...rest], end, more = []) => [
    `JOINT ${name}`, "{", `OFFSET ${offset.join(" ")}`, TURNS,
    ...(rest.length > 0 ? chain(rest, end, more) : ["End Site", "{", `OFFSET ${end.join(" ")}`, "}"]),
    ...(name === "Spine1" ? more : []), "}",
];
const legOf = (side, x) => chain([[`${side}UpLeg`, x * HIP, -4, 0], [`${side}Leg`, 0, -THIGH, 0], [`${side}Foot`, 0, -SHIN, 0],
    [`${side}ToeBase`, 0, -6, 13]], [0, 0, 7]);
const armOf = (side, x) => chain([[`${side}Shoulder`, x * 4, 18, 0], [`${side}Arm`, x * 14, 0, 0], [`${side}ForeArm`, x * 29, 0, 0],
    [`${side}Hand`, x * 25, 0, 0]], [x * 9, 0, 0]);
const back = chain([["Spine", 0, 10, 0], ["Spine1", 0, 18, 0], ["Neck", 0, 23, 0], ["Head", 0, 9, 0]], [0, 16, 0],
    [...armOf("Left", 1), ...armOf("Right", -1)]);
const hierarchy = ["HIERARCHY", "ROOT Hips", "{", "OFFSET 0 0 0",
    "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation", ...legOf("Left", 1), ...legOf("Right", -1), ...back, "}"];
const frames = Array.from({ length: RATE * SECONDS + 1 }, (_, k) => frame(k / RATE).map((value) => Number(value.toFixed(2))).join(" "));
const motion = ["MOTION", `Frames: ${frames.length}`, `Frame Time: ${(1 / RATE).toFixed(7)}`, ...frames];
writeFileSync(new URL("steps.bvh", import.meta.url), `${[...hierarchy, ...motion].join("\n")}\n`);
