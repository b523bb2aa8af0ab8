import type { Numbers } from "./kinopt.js";

/**
 * Placement from a position and a quaternion: a 4 x 4 matrix by columns. The quaternion, `wxyz` or `xyzw`, is normalised.
 * Defaults: the origin, no rotation.
 */
export function placement(position?: Numbers, rotation?: { wxyz?: Numbers; xyzw?: Numbers }): Float64Array;
