//! Conductances between the points of a surface: bounded cotangent weights.

use glam::DVec3;

use super::surface::Surface;

/// Bound of cotangents, which are unbounded in degenerate triangles.
const MAX_COTANGENT: f64 = 1e3;
/// Lower bound of conductances. Obtuse corners give negative ones, which lead to negative weights. Conductances of 0
/// disconnect the surface.
const MIN_CONDUCTANCE: f64 = 1e-3;
/// Lower bound of areas, relative to the mean area.
const MIN_RELATIVE_AREA: f64 = 1e-6;

/// Edges with conductances, and areas of points.
pub(super) struct Stiffness {
    /// (point, point, conductance), the lower point first. Sorted; each edge occurs once.
    pub(super) edges: Vec<(usize, usize, f64)>,
    /// A third of the area of the adjacent triangles.
    pub(super) areas: Vec<f64>,
}

impl Stiffness {
    /// Conductances ½ (cot α + cot β), with α and β the angles opposite the edge (Pinkall & Polthier 1993), within
    /// bounds. All off-diagonal entries of the system are then negative, so its inverse has no negative entry. Weights
    /// are within 0 and 1 on any mesh.
    pub(super) fn new(surface: &Surface) -> Self {
        let mut edges = Vec::with_capacity(3 * surface.triangles.len());
        let mut areas = vec![0.0; surface.points.len()];
        for &triangle in &surface.triangles {
            let [a, b, c] = surface.corners(triangle);
            let area = 0.5 * (b - a).cross(c - a).length();
            for (corner, point) in triangle.into_iter().enumerate() {
                areas[point] += area / 3.0;
                let [next, last] = [1, 2].map(|step| triangle[(corner + step) % 3]);
                let [from, to] =
                    [next, last].map(|end| surface.points[end] - surface.points[point]);
                edges.push((next.min(last), next.max(last), 0.5 * cotangent(from, to)));
            }
        }
        edges.sort_by_key(|edge| (edge.0, edge.1));
        edges.dedup_by(|second, first| {
            let is_duplicate = (second.0, second.1) == (first.0, first.1);
            if is_duplicate {
                first.2 += second.2;
            }
            is_duplicate
        });
        for edge in &mut edges {
            edge.2 = edge.2.max(MIN_CONDUCTANCE);
        }
        let total: f64 = areas.iter().sum();
        let mean = total / areas.len().max(1) as f64;
        let min_area = if mean > 0.0 {
            MIN_RELATIVE_AREA * mean
        } else {
            1.0
        };
        for area in &mut areas {
            *area = area.max(min_area);
        }
        Self { edges, areas }
    }
}

/// Cotangent of the angle between two vectors, within [`MAX_COTANGENT`].
fn cotangent(a: DVec3, b: DVec3) -> f64 {
    let (along, across) = (a.dot(b), a.cross(b).length());
    if along.abs() < MAX_COTANGENT * across {
        along / across
    } else {
        MAX_COTANGENT.copysign(along)
    }
}
