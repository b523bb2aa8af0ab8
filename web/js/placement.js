// Placements from positions and rotations in several representations.
import { InvalidValueError } from "./errors.js";

/**
 * Placement from a position and a quaternion: a 4 x 4 matrix by columns. The quaternion, `wxyz` or `xyzw`, is normalised.
 */
export function placement(position = [0, 0, 0], { wxyz, xyzw } = {}) {
    for (const k of [0, 1, 2]) {
        if (!Number.isFinite(position[k])) throw new TypeError(`position[${k}] is ${position[k]}: expected three finite numbers`);
    }
    if (wxyz && xyzw) throw new InvalidValueError("a placement has one rotation, not wxyz and xyzw");
    const quaternion = wxyz ?? (xyzw ? [xyzw[3], xyzw[0], xyzw[1], xyzw[2]] : [1, 0, 0, 0]);
    const length = Math.sqrt(quaternion[0] ** 2 + quaternion[1] ** 2 + quaternion[2] ** 2 + quaternion[3] ** 2);
    if (!(length > 0 && length < Infinity)) throw new InvalidValueError("a rotation must be a quaternion of four finite numbers, not all 0");
    const [w, x, y, z] = Array.from(quaternion, (value) => value / length);
    return new Float64Array([
        1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y), 0,
        2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x), 0,
        2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y), 0,
        position[0], position[1], position[2], 1,
    ]);
}
