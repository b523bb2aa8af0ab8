//! Support point of a convex hull by hill climbing.
//!
//! On a convex surface, a vertex without a farther neighbour is the farthest of all (Gilbert & Foo 1990). Of thousands
//! of vertices the climb visits a few tens. Rounding can end the climb early, by an error of the size of the rounding.
//! The vertices that are nearly as far form a connected set, so an exact query also visits the neighbours of all of
//! them.

use kinopt_kinematics::spatial::Vector3;

/// Number of vertices below which a linear search is faster.
const MIN_CLIMB_VERTICES: usize = 32;
/// Tolerance relative to the hull's reach, far above the rounding of a projection onto a direction.
const RELATIVE_TOLERANCE: f64 = 1e-12;
/// Largest number of vertices nearly as far as the farthest; with more, as on a wide face, a linear search follows.
const MAX_CANDIDATES: usize = 48;
/// Number of cells along an edge of the cube of directions.
const CELLS_PER_EDGE: usize = 6;

/// Adjacency of the vertices, and start vertices by direction.
#[derive(Clone, Debug)]
pub(super) struct HullClimb {
    /// End of each vertex's range in `neighbours`.
    ends: Vec<u32>,
    neighbours: Vec<u32>,
    /// A vertex far along the middle direction of each cell.
    starts: Vec<u32>,
}

impl HullClimb {
    /// Adjacency of a closed surface; `None` for few vertices.
    pub(super) fn of(vertices: &[Vector3<f64>], triangles: &[[u32; 3]]) -> Option<Self> {
        if vertices.len() < MIN_CLIMB_VERTICES {
            return None;
        }
        let mut ends = vec![0_u32; vertices.len()];
        for &corner in triangles.iter().flatten() {
            ends[corner as usize] += 1;
        }
        let mut sum = 0;
        for end in &mut ends {
            // Starts of the ranges: they become the ends once the neighbours are filled in.
            sum += std::mem::replace(end, sum);
        }
        let mut neighbours = vec![0; sum as usize];
        // Adjacent triangles share each side in opposite directions.
        for &[a, b, c] in triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let end = &mut ends[from as usize];
                neighbours[*end as usize] = to;
                *end += 1;
            }
        }
        let mut climb = Self {
            ends,
            neighbours,
            starts: Vec::with_capacity(6 * CELLS_PER_EDGE * CELLS_PER_EDGE),
        };
        let mut last = 0;
        for cell in 0..6 * CELLS_PER_EDGE * CELLS_PER_EDGE {
            last = climb.climb_from(vertices, last, middle(cell));
            climb.starts.push(last);
        }
        Some(climb)
    }

    /// A vertex without a neighbour farther along a direction.
    pub(super) fn farthest(&self, vertices: &[Vector3<f64>], along: Vector3<f64>) -> Vector3<f64> {
        let start = self.starts[cell(along)];
        vertices[self.climb_from(vertices, start, along) as usize]
    }

    /// The first of the vertices that are farthest along a direction, for a hull of the given reach, metres.
    ///
    /// Returns `None` if too many vertices are nearly as far.
    pub(super) fn try_farthest(
        &self,
        vertices: &[Vector3<f64>],
        along: Vector3<f64>,
        reach: f64,
    ) -> Option<Vector3<f64>> {
        let tolerance =
            RELATIVE_TOLERANCE * reach * along.to_array().map(f64::abs).iter().sum::<f64>();
        let begin = self.climb_from(vertices, self.starts[cell(along)], along);
        let mut best = (begin, along.dot(vertices[begin as usize]));
        if !best.1.is_finite() {
            return None;
        }
        let mut candidates = [begin; MAX_CANDIDATES];
        let (mut visited, mut count) = (0, 1);
        while visited < count {
            for &other in self.neighbours_of(candidates[visited]) {
                let projection = along.dot(vertices[other as usize]);
                if projection < best.1 - tolerance || candidates[..count].contains(&other) {
                    continue;
                }
                *candidates.get_mut(count)? = other;
                count += 1;
                if projection > best.1 || projection == best.1 && other < best.0 {
                    best = (other, projection);
                }
            }
            visited += 1;
        }
        Some(vertices[best.0 as usize])
    }

    fn neighbours_of(&self, corner: u32) -> &[u32] {
        let corner = corner as usize;
        let begin = corner.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.neighbours[begin as usize..self.ends[corner] as usize]
    }

    fn climb_from(&self, vertices: &[Vector3<f64>], start: u32, along: Vector3<f64>) -> u32 {
        let mut best = (start, along.dot(vertices[start as usize]));
        loop {
            let corner = best.0;
            for &other in self.neighbours_of(corner) {
                let projection = along.dot(vertices[other as usize]);
                if projection > best.1 {
                    best = (other, projection);
                }
            }
            if best.0 == corner {
                return corner;
            }
        }
    }
}

/// Index of the cell of the cube's surface that a direction passes through.
fn cell(along: Vector3<f64>) -> usize {
    let v = along.to_array();
    let size = v.map(f64::abs);
    let axis = match (size[0] >= size[1] && size[0] >= size[2], size[1] >= size[2]) {
        (true, _) => 0,
        (_, true) => 1,
        _ => 2,
    };
    let scale = size[axis].recip();
    let cell_along = |value: f64| {
        // NaN for a zero direction gives the first cell.
        let cell = (value * scale + 1.0) * (0.5 * CELLS_PER_EDGE as f64);
        (cell as usize).min(CELLS_PER_EDGE - 1)
    };
    let side = 2 * axis + usize::from(v[axis] < 0.0);
    (side * CELLS_PER_EDGE + cell_along(v[(axis + 1) % 3])) * CELLS_PER_EDGE
        + cell_along(v[(axis + 2) % 3])
}

/// Direction through the middle of a cell.
fn middle(cell: usize) -> Vector3<f64> {
    let coordinate = |cell: usize| (cell as f64 + 0.5) * (2.0 / CELLS_PER_EDGE as f64) - 1.0;
    let (side, row, column) = (
        cell / (CELLS_PER_EDGE * CELLS_PER_EDGE),
        cell / CELLS_PER_EDGE % CELLS_PER_EDGE,
        cell % CELLS_PER_EDGE,
    );
    let axis = side / 2;
    let mut v = [0.0; 3];
    v[axis] = if side % 2 == 0 { 1.0 } else { -1.0 };
    v[(axis + 1) % 3] = coordinate(row);
    v[(axis + 2) % 3] = coordinate(column);
    Vector3::from(v)
}

#[cfg(test)]
#[allow(clippy::panic)]
mod tests {
    use super::MAX_CANDIDATES;
    use crate::collision::{Shape, ShapeKind};
    use kinopt_kinematics::random::RandomStream;
    use kinopt_kinematics::spatial::Vector3;

    /// Points on a sphere, on a prism with many sides, on a thin disc, and on a spherical cap far from the origin.
    fn points(kind: u64, random: &mut RandomStream) -> Vec<Vector3<f64>> {
        let mut unit = || {
            let v = Vector3::new(
                random.unit() - 0.5,
                random.unit() - 0.5,
                random.unit() - 0.5,
            );
            v * v.norm().recip()
        };
        let all = (0..1500).map(|_| unit());
        match kind {
            0 => all.collect(),
            1 => all
                .map(|u| {
                    Vector3::new(u.x, u.y, 0.0) * (u.x * u.x + u.y * u.y).sqrt().recip()
                        + Vector3::new(0.0, 0.0, 1_f64.copysign(u.z))
                })
                .collect(),
            2 => all.map(|u| Vector3::new(u.x, u.y, 1e-4 * u.z)).collect(),
            _ => all
                .map(|u| Vector3::new(1e3 + 1e-2 * u.x, 7.0 + u.y.abs(), u.z))
                .collect(),
        }
    }

    #[test]
    fn hull_climb_finds_the_farthest_vertex() {
        let mut random = RandomStream::new(5, 0);
        let (mut by_climbing, mut queries) = (0, 0);
        for kind in 0..4 {
            let shape = Shape::convex(&points(kind, &mut random));
            let Ok(ShapeKind::Convex(hull)) = shape.as_ref().map(Shape::kind) else {
                panic!("{kind}: {shape:?}");
            };
            let faces = hull.planes().iter().map(|(normal, _)| *normal);
            let corners = hull.vertices().iter().copied();
            let sampled = (0..2000).map(|_| {
                let mut part = || random.unit() - 0.5;
                Vector3::new(part(), part(), part())
            });
            let sampled: Vec<_> = sampled.collect();
            let axes = Vector3::UNITS
                .into_iter()
                .flat_map(|axis| [axis, -axis, axis * 1e-30]);
            for along in faces.chain(corners).chain(sampled).chain(axes) {
                let mut expected = (f64::NEG_INFINITY, hull.vertices()[0]);
                for &corner in hull.vertices() {
                    let projection = along.dot(corner);
                    if projection > expected.0 {
                        expected = (projection, corner);
                    }
                }
                assert_eq!(hull.farthest(along), expected.1, "{kind}: {along:?}");
                queries += 1;
                let climb = hull.climb();
                let climbed =
                    climb.and_then(|c| c.try_farthest(hull.vertices(), along, hull.reach()));
                by_climbing += u32::from(climbed.is_some());
            }
        }
        assert!(
            by_climbing > queries / 2 && MAX_CANDIDATES > 8,
            "{by_climbing} of {queries}"
        );
    }
}
