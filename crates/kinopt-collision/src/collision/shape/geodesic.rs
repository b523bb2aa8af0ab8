//! Geodesic polyhedron around the unit ball.

use std::collections::BTreeMap;

use kinopt_kinematics::spatial::Vector3;

/// Number of subdivisions of each triangle into four.
const SUBDIVISIONS: usize = 2;

/// Vertices of a polyhedron that encloses the unit ball: an icosahedron, subdivided and projected onto the sphere
/// (Fuller's geodesic dome), then scaled until its faces lie outside the ball.
pub(super) fn around_unit_ball() -> Vec<Vector3<f64>> {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut corners = Vec::new();
    for (a, b) in [
        (1.0, golden),
        (1.0, -golden),
        (-1.0, golden),
        (-1.0, -golden),
    ] {
        corners.extend([
            Vector3::new(0.0, a, b),
            Vector3::new(a, b, 0.0),
            Vector3::new(b, 0.0, a),
        ]);
    }
    // Adjacent corners are 2 apart, all other pairs are farther apart.
    let are_adjacent = |i: usize, j: usize, corners: &[Vector3<f64>]| {
        (corners[i] - corners[j]).norm_squared() < 4.5
    };
    let mut triangles = Vec::new();
    for i in 0..corners.len() {
        for j in i + 1..corners.len() {
            for k in j + 1..corners.len() {
                if are_adjacent(i, j, &corners)
                    && are_adjacent(j, k, &corners)
                    && are_adjacent(i, k, &corners)
                {
                    triangles.push([i, j, k]);
                }
            }
        }
    }
    corners
        .iter_mut()
        .for_each(|corner| *corner = unit(*corner));
    for _ in 0..SUBDIVISIONS {
        let mut midpoints: BTreeMap<(usize, usize), usize> = BTreeMap::new();
        let mut midpoint = |a: usize, b: usize| {
            *midpoints.entry((a.min(b), a.max(b))).or_insert_with(|| {
                corners.push(unit(corners[a] + corners[b]));
                corners.len() - 1
            })
        };
        let mut split = Vec::with_capacity(4 * triangles.len());
        for &[a, b, c] in &triangles {
            let (ab, bc, ca) = (midpoint(a, b), midpoint(b, c), midpoint(c, a));
            split.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        triangles = split;
    }
    // Smallest distance of a triangle's plane from the origin.
    let inner_radius = triangles.iter().map(|triangle| {
        let [a, b, c] = triangle.map(|corner| corners[corner]);
        unit((b - a).cross(c - a)).dot(a).abs()
    });
    let inner_radius = inner_radius.fold(1.0, f64::min);
    corners
        .iter()
        .map(|corner| *corner * inner_radius.recip())
        .collect()
}

fn unit(p: Vector3<f64>) -> Vector3<f64> {
    p * p.norm().recip()
}
