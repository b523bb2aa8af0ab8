//! Vertex welding and edge adjacency of triangle meshes.

use std::collections::HashMap;

use super::ShapeNote;
use kinopt_kinematics::spatial::Vector3;

/// The used vertices without duplicates, and the triangles with three distinct vertices.
pub(super) fn welded(
    vertices: &[Vector3<f64>],
    triangles: &[[u32; 3]],
) -> (Vec<Vector3<f64>>, Vec<[u32; 3]>) {
    let mut indices: HashMap<[u64; 3], u32> = HashMap::new();
    let mut distinct = Vec::new();
    let mut weld = |vertex: u32| {
        // Makes −0 and +0 equal.
        let position = vertices[vertex as usize] + Vector3::zero();
        let bits = position.to_array().map(f64::to_bits);
        *indices.entry(bits).or_insert_with(|| {
            distinct.push(position);
            distinct.len() as u32 - 1
        })
    };
    let triangles = triangles.iter().map(|corners| corners.map(&mut weld));
    let with_area = triangles.filter(|[a, b, c]| a != b && b != c && c != a);
    let with_area = with_area.collect();
    (distinct, with_area)
}

/// The adjacent triangle across each side, if the mesh is closed and consistently wound.
pub(super) fn across(triangles: &[[u32; 3]]) -> Result<Vec<[u32; 3]>, ShapeNote> {
    // Each side: its ends in order, whether it is reversed, its triangle, and its index in the triangle.
    let mut sides = Vec::with_capacity(3 * triangles.len());
    for (t, corners) in triangles.iter().enumerate() {
        for side in 0..3 {
            let (from, to) = (corners[side], corners[(side + 1) % 3]);
            sides.push((from.min(to), from.max(to), from > to, t as u32, side));
        }
    }
    sides.sort_unstable();
    let mut adjacent = vec![[0; 3]; triangles.len()];
    let (mut open, mut misoriented) = (0, 0);
    for edge in sides.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        match edge {
            [a, b] if a.2 != b.2 => {
                adjacent[a.3 as usize][a.4] = b.3;
                adjacent[b.3 as usize][b.4] = a.3;
            }
            [_, _] => misoriented += 1,
            _ => open += 1,
        }
    }
    match (open, misoriented) {
        (0, 0) => Ok(adjacent),
        (0, edges) => Err(ShapeNote::Winding { edges }),
        (edges, _) => Err(ShapeNote::Open { edges }),
    }
}
