//! Sides of a box whose corners are numbered by the bits of x, y and z.

/// Corners of each side, counter-clockwise as seen from outside.
pub const BOX_SIDES: [[u32; 4]; 6] = [
    [0, 2, 3, 1],
    [4, 5, 7, 6],
    [0, 1, 5, 4],
    [2, 6, 7, 3],
    [0, 4, 6, 2],
    [1, 3, 7, 5],
];

/// Two triangles per side.
pub fn box_triangles() -> Vec<[u32; 3]> {
    let halves = BOX_SIDES.map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
    halves.concat()
}
