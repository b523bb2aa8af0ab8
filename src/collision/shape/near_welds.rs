//! Meshes that are open only because corners that should be one are next to each other.

use std::collections::HashMap;

use super::triangle_sides::{across, welded};
use crate::collision::bounding_box::BoundingBox;
use crate::spatial::Vector3;

/// Corners at most so far apart, as a share of the mesh's size, may be one: some steps of single precision, in which STL's are written.
pub(super) const TOLERANCE: f64 = 1e-6;

/// A mesh that is closed once corners on its open edges are one.
pub(super) struct Closed {
    pub(super) vertices: Vec<Vector3<f64>>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// By triangle: the triangles beyond its sides.
    pub(super) across: Vec<[u32; 3]>,
    /// From one end of the box around all to the other.
    pub(super) size: f64,
}

/// Makes corners on open edges one with the first that is within the tolerance; `None` where that does not close the mesh.
pub(super) fn closed(vertices: &[Vector3<f64>], triangles: &[[u32; 3]]) -> Option<Closed> {
    let bounds = BoundingBox::around(vertices.iter().copied());
    let size = (bounds.max - bounds.min).norm();
    let within = TOLERANCE * size;
    let mut on_edges = open_corners(triangles);
    on_edges.sort_unstable();
    on_edges.dedup();
    let cell = |place: Vector3<f64>| {
        let from = (place - bounds.min).to_array();
        from.map(|x| (x / within) as i64)
    };
    // The first corners of each cell, which are as wide as the tolerance.
    let mut first_in: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    let mut places = vertices.to_vec();
    let mut made_one = false;
    for corner in on_edges {
        let place = vertices[corner as usize];
        let own = cell(place);
        let around =
            (0..27).map(|k| [0, 1, 2].map(|axis| own[axis] + k / 3_i64.pow(axis as u32) % 3 - 1));
        let known = around.filter_map(|cell| first_in.get(&cell)).flatten();
        let near = known.filter(|known| (vertices[**known as usize] - place).norm() <= within);
        match near.min() {
            Some(first) => {
                places[corner as usize] = vertices[*first as usize];
                made_one = true;
            }
            None => first_in.entry(own).or_default().push(corner),
        }
    }
    if !made_one {
        return None;
    }
    let (vertices, triangles) = welded(&places, triangles);
    let across = across(&triangles).ok()?;
    (!triangles.is_empty()).then_some(Closed {
        vertices,
        triangles,
        across,
        size,
    })
}

/// The ends of all edges that are not of two triangles.
fn open_corners(triangles: &[[u32; 3]]) -> Vec<u32> {
    let sides = triangles
        .iter()
        .flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]);
    let mut sides: Vec<[u32; 2]> = sides.map(|[a, b]| [*a.min(b), *a.max(b)]).collect();
    sides.sort_unstable();
    let open = sides.chunk_by(|a, b| a == b).filter(|edge| edge.len() != 2);
    open.flat_map(|edge| edge[0]).collect()
}
