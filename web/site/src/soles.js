// Feet of a rig and the soles of its skin.
import { ForwardKinematics } from "kinopt";

/** Feet are nearly level with the lowest pinned tip, and far below the root, relative to the height of the rig. */
const [LEVEL_TOLERANCE, MIN_ROOT_HEIGHT] = [0.06, 0.25];
/** Height of a sole's part of the skin, relative to the height of the rig. */
const SOLE_THICKNESS = 0.015;

/**
 * Feet of a rig with a skin: at least two pinned tips at its bottom. `soles` are the corners of their part of the skin
 * near the ground by the frame of the tip, in its coordinates. z is up.
 */
export function solesOf(rig) {
    const none = { soles: {}, feet: [] };
    if (rig.triangles.length === 0) return none;
    const q = rig.model.neutral();
    const posing = rig.posing("lbs");
    posing.deform(q);
    const skin = posing.positions.slice();
    const [floor, top] = extent(skin);
    const height = top - floor;
    const frames = [rig.model.frameNames[0], ...rig.constrained.map((bone) => rig.skeleton.tip(bone))];
    const placed = new ForwardKinematics(rig.model, frames).place(q).slice();
    const placement = (k) => placed.subarray(16 * k, 16 * k + 16);
    const high = (k) => placement(k)[14] - floor;
    const low = rig.constrained.map((_, k) => k + 1).filter((k) => high(k) < LEVEL_TOLERANCE * height);
    if (low.length < 2 || high(0) < MIN_ROOT_HEIGHT * height) return none;
    const soles = new Map(low.map((k) => [k, []]));
    for (let v = 0; v < skin.length; v += 3) {
        if (skin[v + 2] > floor + SOLE_THICKNESS * height) continue;
        const distance = (k) => Math.hypot(skin[v] - placement(k)[12], skin[v + 1] - placement(k)[13]);
        const nearest = low.reduce((best, k) => (distance(k) < distance(best) ? k : best));
        soles.get(nearest).push([skin[v], skin[v + 1]]);
    }
    const corners = (k) => box(soles.get(k)).map(([x, y]) => local(placement(k), [x, y, floor]));
    return {
        soles: Object.fromEntries(low.map((k) => [frames[k], corners(k)])),
        feet: low.map((k) => rig.constrained[k - 1]),
        height,
        floor,
    };
}

/** Lowest and highest z of points. */
function extent(points) {
    let [lowest, highest] = [Infinity, -Infinity];
    for (let k = 2; k < points.length; k += 3) [lowest, highest] = [Math.min(lowest, points[k]), Math.max(highest, points[k])];
    return [lowest, highest];
}

/** Corners of the box around points, seen from above. */
function box(points) {
    const range = (axis) => points.reduce(([low, high], point) => [Math.min(low, point[axis]), Math.max(high, point[axis])], [Infinity, -Infinity]);
    const [[left, right], [near, far]] = [range(0), range(1)];
    return [[left, near], [right, near], [right, far], [left, far]];
}

/** A point of the world in the coordinates of a placement. */
function local(m, point) {
    const offset = point.map((value, k) => value - m[12 + k]);
    return [0, 1, 2].map((column) => offset.reduce((sum, value, row) => sum + value * m[4 * column + row], 0));
}
