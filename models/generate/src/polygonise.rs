//! Fine closed mesh of a surface: surface nets (Gibson 1998) on a regular grid.
//!
//! Each sheet through a cell has its own vertex (Nielson 2004, "Dual marching cubes"). Sheets with a shared vertex
//! would not be a manifold.

use std::collections::HashMap;

use glam::{DVec3, UVec3};

use crate::surface::Surface;

/// Edge length in cells of a block that is skipped far from the surface.
const BLOCK: u32 = 6;
/// Corners of a cell; below, its edges as pairs of corners.
const CORNERS: [[u32; 3]; 8] = [
    [0, 0, 0],
    [1, 0, 0],
    [0, 1, 0],
    [1, 1, 0],
    [0, 0, 1],
    [1, 0, 1],
    [0, 1, 1],
    [1, 1, 1],
];
const EDGES: [(usize, usize); 12] = [
    (0, 1),
    (2, 3),
    (4, 5),
    (6, 7),
    (0, 2),
    (1, 3),
    (4, 6),
    (5, 7),
    (0, 4),
    (1, 5),
    (2, 6),
    (3, 7),
];

/// Vertices and counter-clockwise triangles.
#[derive(Clone, Debug, Default)]
pub(crate) struct Soup {
    pub(crate) positions: Vec<DVec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

struct Grid {
    low: DVec3,
    step: f64,
    /// Number of nodes along each axis.
    nodes: UVec3,
    distances: Vec<f64>,
}

impl Grid {
    fn sample(surface: &Surface, low: DVec3, high: DVec3, step: f64) -> Self {
        let blocks = ((high - low) / (step * f64::from(BLOCK))).ceil().as_uvec3();
        let nodes = blocks * BLOCK + UVec3::ONE;
        let count = nodes.as_usizevec3().element_product();
        let mut grid = Self {
            low,
            step,
            nodes,
            distances: vec![f64::INFINITY; count],
        };
        // Largest distance of a corner from its block's centre.
        let reach = 0.5 * f64::from(BLOCK) * step * 3.0_f64.sqrt();
        for block in cells(blocks) {
            let first = block * BLOCK;
            let centre = grid.at(first) + DVec3::splat(0.5 * f64::from(BLOCK) * step);
            let block_distance = surface.distance(centre);
            for node in cells(UVec3::splat(BLOCK + 1)) {
                let index = grid.index(first + node);
                if block_distance.abs() <= reach {
                    grid.distances[index] = surface.distance(grid.at(first + node));
                } else if grid.distances[index].is_infinite() {
                    // Only the sign is used, as no surface is near.
                    grid.distances[index] = block_distance;
                }
            }
        }
        grid
    }

    fn at(&self, node: UVec3) -> DVec3 {
        self.low + node.as_dvec3() * self.step
    }

    fn index(&self, node: UVec3) -> usize {
        let (node, nodes) = (node.as_usizevec3(), self.nodes.as_usizevec3());
        (node.z * nodes.y + node.y) * nodes.x + node.x
    }
}

fn cells(counts: UVec3) -> impl Iterator<Item = UVec3> {
    (0..counts.z).flat_map(move |z| {
        (0..counts.y).flat_map(move |y| (0..counts.x).map(move |x| UVec3::new(x, y, z)))
    })
}

/// Mesh of the surface within a box, on a grid of cubes with edges of `step` metres.
pub(crate) fn polygonise(surface: &Surface, low: DVec3, high: DVec3, step: f64) -> Soup {
    let grid = Grid::sample(surface, low, high, step);
    let mut soup = Soup::default();
    // Vertex of each cell around a grid edge, by the cell and the two corners of the edge.
    let mut vertex_of = HashMap::new();
    for cell in cells(grid.nodes - UVec3::ONE) {
        let nodes = CORNERS.map(|corner| cell + UVec3::from_array(corner));
        let distances = nodes.map(|node| grid.distances[grid.index(node)]);
        let sheet_of = components(distances.map(|distance| distance < 0.0));
        let mut sheets: Vec<((usize, usize), DVec3, f64, u32)> = Vec::new();
        for (a, b) in EDGES {
            if (distances[a] < 0.0) == (distances[b] < 0.0) {
                continue;
            }
            let sides = (sheet_of[a].min(sheet_of[b]), sheet_of[a].max(sheet_of[b]));
            let share = distances[a] / (distances[a] - distances[b]);
            let crossing = grid.at(nodes[a]).lerp(grid.at(nodes[b]), share);
            let known = sheets.iter().position(|sheet| sheet.0 == sides);
            let known = known.unwrap_or_else(|| {
                let vertex = (soup.positions.len() + sheets.len()) as u32;
                sheets.push((sides, DVec3::ZERO, 0.0, vertex));
                sheets.len() - 1
            });
            let (_, sum, count, vertex) = &mut sheets[known];
            *sum += crossing;
            *count += 1.0;
            vertex_of.insert(
                (grid.index(cell), grid.index(nodes[a]), grid.index(nodes[b])),
                *vertex,
            );
        }
        soup.positions
            .extend(sheets.iter().map(|(_, sum, count, _)| *sum / *count));
    }
    // Adds a quad around each grid edge that crosses the surface.
    for node in cells(grid.nodes - UVec3::ONE) {
        let inside = grid.distances[grid.index(node)] < 0.0;
        for (axis, u, v) in [
            (UVec3::X, UVec3::Y, UVec3::Z),
            (UVec3::Y, UVec3::Z, UVec3::X),
            (UVec3::Z, UVec3::X, UVec3::Y),
        ] {
            let other = grid.distances[grid.index(node + axis)] < 0.0;
            let Some(corner) = node.checked_sub(u + v) else {
                continue;
            };
            if inside == other {
                continue;
            }
            let around = [corner, corner + u, corner + u + v, corner + v];
            let [a, b, c, d] = around.map(|cell| {
                let edge = (grid.index(cell), grid.index(node), grid.index(node + axis));
                vertex_of.get(&edge).copied().unwrap_or_default()
            });
            let [a, b, c, d] = if inside { [a, b, c, d] } else { [a, d, c, b] };
            let length = |i: u32, j: u32| {
                soup.positions[i as usize].distance_squared(soup.positions[j as usize])
            };
            let quad = if length(a, c) <= length(b, d) {
                [[a, b, c], [a, c, d]]
            } else {
                [[a, b, d], [b, c, d]]
            };
            soup.triangles.extend(quad);
        }
    }
    soup
}

/// Numbers the connected groups of a cell's corners. Corners inside connect along edges, corners outside also across
/// faces.
fn components(inside: [bool; 8]) -> [usize; 8] {
    let mut group: [usize; 8] = std::array::from_fn(|corner| corner);
    // Corner numbers differ in one bit along an edge and in two across a face.
    for _ in 0..7 {
        for a in 0..8_usize {
            for b in 0..8_usize {
                let differing_bits = (a ^ b).count_ones();
                if inside[a] == inside[b]
                    && (differing_bits == 1 || (differing_bits == 2 && !inside[a]))
                {
                    group[a] = group[a].min(group[b]);
                }
            }
        }
    }
    group
}
