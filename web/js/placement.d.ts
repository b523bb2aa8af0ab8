import type { Numbers } from "./kinopt.js";

/** A placement of a place and a quaternion, `wxyz` or `xyzw`, of any length but 0: a 4 x 4 matrix by columns. */
export function placement(position?: Numbers, rotation?: { wxyz?: Numbers; xyzw?: Numbers }): Float64Array;
