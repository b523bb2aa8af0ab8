//! Penetration depth of convex cores by the expanding polytope algorithm (EPA; van den Bergen 2001).
//!
//! The polytope grows from any four vertices of A − B. It need not contain the origin at first: for cores that just
//! touch, its faces give the direction as they do for overlapping cores.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use crate::collision::convex_surface::ConvexSurface;
use kinopt_kinematics::spatial::Vector3;

use super::core_and_radius::{Corner, Gap, Pair};

/// Iteration limit. Coaxial round bodies would use any number; the remaining error is then negligible.
const ITERATIONS: usize = 400;
/// Tolerance of convergence, relative to the scale of the pair.
const CONVERGENCE_TOLERANCE: f64 = 1e-14;
/// Thickness below which A − B counts as flat, relative to the scale of the pair.
const FLATNESS_TOLERANCE: f64 = 1e-13;

/// Plane of a facet.
#[derive(Clone, Copy, PartialEq)]
struct FacetPlane {
    /// Distance of the plane from the origin; positive if the origin is inside.
    depth: f64,
    normal: Vector3<f64>,
    facet: u32,
}

/// The shortest translation of B that separates it from A, or the small gap between them.
///
/// `meeting` holds the points where both meet.
pub(super) fn depth(pair: &Pair<'_>, meeting: Corner) -> Gap {
    let (scale, climbed) = (pair.scale(), pair.is_climbed());
    let corners = match spanning(pair, scale, meeting) {
        Ok(corners) => corners,
        Err(flat) => return flat,
    };
    let Some(mut surface) = ConvexSurface::tetrahedron(corners.map(|c| c.difference())) else {
        return across(pair, meeting, Vector3::UNITS[2]);
    };
    let mut corners = corners.to_vec();
    // `tetrahedron` may have swapped the first two.
    if corners[0].difference() != surface.points[0] {
        corners.swap(0, 1);
    }
    let mut queue = BinaryHeap::new();
    queue.extend((0..4).filter_map(|facet| plane(&surface, facet)));
    let mut best: Option<(f64, Vector3<f64>)> = None;
    for _ in 0..ITERATIONS {
        let Some(nearest) = queue.pop() else { break };
        if !surface.facets[nearest.facet as usize].alive {
            continue;
        }
        let mut corner = pair.approximate_support(nearest.normal);
        // The overlap along a direction is an upper bound of the depth.
        let overlap = |corner: &Corner| corner.difference().dot(nearest.normal);
        let has_converged =
            |corner: &Corner| overlap(corner) - nearest.depth <= CONVERGENCE_TOLERANCE * scale;
        if climbed && has_converged(&corner) {
            corner = pair.support(nearest.normal);
        }
        if best.is_none_or(|(depth, _)| overlap(&corner) < depth) {
            best = Some((overlap(&corner), nearest.normal));
        }
        if has_converged(&corner) {
            break;
        }
        let point = corner.difference();
        // The normal of a sliver may be wrong by rounding; its neighbours are more accurate.
        if !surface.sees(nearest.facet, point) {
            continue;
        }
        corners.push(corner);
        surface.insert(point, nearest.facet);
        queue.extend(
            surface
                .new_facets
                .iter()
                .filter_map(|&f| plane(&surface, f)),
        );
    }
    let (mut depth, normal) = best.unwrap_or((0.0, Vector3::UNITS[2]));
    if climbed && best.is_some() {
        // The exact support replaces the climbed one, which may stop early.
        depth = -pair.gap_along(normal);
    }
    witness(&surface, &corners, normal, depth)
}

/// Four vertices that span a volume. The error is the gap along the normal if A − B is flat.
fn spanning(pair: &Pair<'_>, scale: f64, meeting: Corner) -> Result<[Corner; 4], Gap> {
    let min_thickness = FLATNESS_TOLERANCE * scale;
    let widest = Vector3::UNITS.map(|axis| {
        [
            pair.approximate_support(axis),
            pair.approximate_support(-axis),
        ]
    });
    let width = |[a, b]: &[Corner; 2]| (a.difference() - b.difference()).norm();
    let [a, b] = widest.into_iter().fold(widest[0], |best, ends| {
        if width(&ends) > width(&best) {
            ends
        } else {
            best
        }
    });
    let along = b.difference() - a.difference();
    if along.norm() <= min_thickness {
        // A single point: the direction from it to the origin.
        let offset = a.difference();
        let towards_origin = -offset;
        return Err(across(
            pair,
            meeting,
            unit(towards_origin).unwrap_or(Vector3::UNITS[2]),
        ));
    }
    let perpendicular_a = perpendicular(along);
    let perpendicular_b = unit(along.cross(perpendicular_a)).unwrap_or(perpendicular_a);
    let from_line = |c: &Corner| along.cross(c.difference() - a.difference()).norm() / along.norm();
    let c = [
        perpendicular_a,
        -perpendicular_a,
        perpendicular_b,
        -perpendicular_b,
    ]
    .map(|direction| pair.approximate_support(direction))
    .into_iter()
    .fold(a, |best, c| {
        if from_line(&c) > from_line(&best) {
            c
        } else {
            best
        }
    });
    if from_line(&c) <= min_thickness {
        // A line: the direction from it to the origin, perpendicular to it.
        let offset = a.difference();
        let out = offset - along * (offset.dot(along) / along.norm_squared());
        let out = if out.norm() > min_thickness {
            unit(-out)
        } else {
            None
        };
        return Err(across(pair, meeting, out.unwrap_or(perpendicular_a)));
    }
    let normal = along.cross(c.difference() - a.difference());
    let normal = unit(normal).unwrap_or(perpendicular_a);
    let above = |corner: &Corner| (corner.difference() - a.difference()).dot(normal).abs();
    let [up, down] = [normal, -normal].map(|direction| pair.approximate_support(direction));
    let d = if above(&up) >= above(&down) { up } else { down };
    if above(&d) <= min_thickness {
        // A plane: its normal on the side of the origin.
        let out = if a.difference().dot(normal) > 0.0 {
            -normal
        } else {
            normal
        };
        return Err(across(pair, meeting, out));
    }
    Ok([a, b, c, d])
}

/// The gap along the normal of a flat difference.
fn across(pair: &Pair<'_>, meeting: Corner, normal: Vector3<f64>) -> Gap {
    let depth = -pair.gap_along(normal);
    Gap {
        distance: -depth,
        on_a: meeting.on_a,
        on_b: meeting.on_a - normal * depth,
        normal,
    }
}

fn unit(v: Vector3<f64>) -> Option<Vector3<f64>> {
    let length = v.norm();
    (length > 0.0).then(|| v * length.recip())
}

/// A unit vector perpendicular to another, from the coordinate axis with the smallest component.
fn perpendicular(v: Vector3<f64>) -> Vector3<f64> {
    let [x, y, z] = v.to_array().map(f64::abs);
    let axis = if x <= y && x <= z {
        0
    } else if y <= z {
        1
    } else {
        2
    };
    unit(v.cross(Vector3::UNITS[axis])).unwrap_or(Vector3::UNITS[2])
}

/// The plane of a facet, if the facet is wide enough to define it.
fn plane(surface: &ConvexSurface, facet: u32) -> Option<FacetPlane> {
    let [a, b, c] = surface.corners(facet);
    let sides = [b - a, c - b, a - c];
    let longest = sides.iter().map(|s| s.norm_squared()).fold(0.0, f64::max);
    // The cross product of the two shorter sides has the least rounding.
    let i = (0..3).find(|&i| sides[i].norm_squared() == longest)?;
    let normal = sides[(i + 1) % 3].cross(sides[(i + 2) % 3]);
    let area = normal.norm();
    (area > 1e-14 * longest).then(|| {
        let normal = normal * area.recip();
        FacetPlane {
            depth: normal.dot(a),
            normal,
            facet,
        }
    })
}

/// Contact points after the separation by `depth` along `normal`: the point of the surface next to the end of that
/// translation. All facets are searched, since coplanar facets are equally near.
fn witness(surface: &ConvexSurface, corners: &[Corner], normal: Vector3<f64>, depth: f64) -> Gap {
    let end = normal * depth;
    let mut best = (f64::INFINITY, Vector3::zero());
    for (index, facet) in surface.facets.iter().enumerate().filter(|(_, f)| f.alive) {
        let triangle = surface.corners(index as u32);
        let weights = weights_of(end, triangle);
        let sum = |[a, b, c]: [Vector3<f64>; 3]| a * weights[0] + b * weights[1] + c * weights[2];
        let squared_distance = (sum(triangle) - end).norm_squared();
        if squared_distance < best.0 {
            best = (
                squared_distance,
                sum(facet.corners.map(|i| corners[i as usize].on_a)),
            );
        }
    }
    Gap {
        distance: -depth,
        on_a: best.1,
        on_b: best.1 - end,
        normal,
    }
}

/// Barycentric weights of the point of a triangle that is nearest to a point of its plane.
///
/// For a sliver the point lies on a side.
fn weights_of(p: Vector3<f64>, [a, b, c]: [Vector3<f64>; 3]) -> [f64; 3] {
    let area = (b - a).cross(c - a);
    let scale = area.norm_squared().recip();
    let v = (p - a).cross(c - a).dot(area) * scale;
    let w = (b - a).cross(p - a).dot(area) * scale;
    let inner = [1.0 - v - w, v, w];
    if inner.iter().all(|w| (0.0..=1.0).contains(w)) {
        return inner;
    }
    let along = |from: Vector3<f64>, to: Vector3<f64>| {
        let side = to - from;
        let share = (p - from).dot(side) / side.norm_squared();
        let share = if share.is_nan() {
            0.0
        } else {
            share.clamp(0.0, 1.0)
        };
        ((from + side * share - p).norm_squared(), share)
    };
    let [ab, bc, ca] = [along(a, b), along(b, c), along(c, a)];
    if ab.0 <= bc.0 && ab.0 <= ca.0 {
        [1.0 - ab.1, ab.1, 0.0]
    } else if bc.0 <= ca.0 {
        [0.0, 1.0 - bc.1, bc.1]
    } else {
        [ca.1, 0.0, 1.0 - ca.1]
    }
}

impl Eq for FacetPlane {}

impl PartialOrd for FacetPlane {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The plane nearest to the origin first; among equally near planes the oldest.
impl Ord for FacetPlane {
    fn cmp(&self, other: &Self) -> Ordering {
        let nearer = other.depth.total_cmp(&self.depth);
        nearer.then(other.facet.cmp(&self.facet))
    }
}
