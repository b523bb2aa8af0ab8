//! Closing of open meshes by merging vertices that nearly coincide.

use std::collections::HashMap;

use super::triangle_sides::{across, welded};
use crate::collision::bounding_box::BoundingBox;
use kinopt_kinematics::spatial::Vector3;

/// Largest distance of merged vertices, relative to the mesh's size: a few steps of single precision, as STL files use.
pub(super) const TOLERANCE: f64 = 1e-6;

/// A mesh that was closed by merging vertices on its open edges.
pub(super) struct Closed {
    pub(super) vertices: Vec<Vector3<f64>>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// Adjacent triangle across each side, by triangle.
    pub(super) across: Vec<[u32; 3]>,
    /// Diagonal of the bounding box, metres.
    pub(super) size: f64,
}

/// Merges each vertex on an open edge with the first vertex within the tolerance. Returns `None` if that does not close
/// the mesh.
pub(super) fn closed(vertices: &[Vector3<f64>], triangles: &[[u32; 3]]) -> Option<Closed> {
    let bounds = BoundingBox::around(vertices.iter().copied());
    let size = (bounds.max - bounds.min).norm();
    let tolerance = TOLERANCE * size;
    let mut on_edges = open_corners(triangles);
    on_edges.sort_unstable();
    on_edges.dedup();
    let cell = |position: Vector3<f64>| {
        let from = (position - bounds.min).to_array();
        from.map(|x| (x / tolerance) as i64)
    };
    // Unmerged vertices by cell. The cells are as wide as the tolerance.
    let mut first_in: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    let mut positions = vertices.to_vec();
    let mut has_merged = false;
    for corner in on_edges {
        let position = vertices[corner as usize];
        let vertex_cell = cell(position);
        let neighbour_cells = (0..27)
            .map(|k| [0, 1, 2].map(|axis| vertex_cell[axis] + k / 3_i64.pow(axis as u32) % 3 - 1));
        let unmerged = neighbour_cells
            .filter_map(|cell| first_in.get(&cell))
            .flatten();
        let close = unmerged
            .filter(|unmerged| (vertices[**unmerged as usize] - position).norm() <= tolerance);
        match close.min() {
            Some(first) => {
                positions[corner as usize] = vertices[*first as usize];
                has_merged = true;
            }
            None => first_in.entry(vertex_cell).or_default().push(corner),
        }
    }
    if !has_merged {
        return None;
    }
    let (vertices, triangles) = welded(&positions, triangles);
    let across = across(&triangles).ok()?;
    (!triangles.is_empty()).then_some(Closed {
        vertices,
        triangles,
        across,
        size,
    })
}

/// The end vertices of all edges that do not join exactly two triangles.
fn open_corners(triangles: &[[u32; 3]]) -> Vec<u32> {
    let sides = triangles
        .iter()
        .flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]);
    let mut sides: Vec<[u32; 2]> = sides.map(|[a, b]| [*a.min(b), *a.max(b)]).collect();
    sides.sort_unstable();
    let open = sides.chunk_by(|a, b| a == b).filter(|edge| edge.len() != 2);
    open.flat_map(|edge| edge[0]).collect()
}
