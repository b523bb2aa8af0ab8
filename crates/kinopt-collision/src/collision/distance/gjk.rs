//! Distance of separated convex cores by the GJK algorithm (Gilbert, Johnson & Keerthi 1988).

use kinopt_kinematics::spatial::Vector3;

use super::core_and_radius::{Corner, Gap, Pair};
use super::simplex::Simplex;

/// Iteration limit. Polyhedra need a dozen iterations, round bodies more.
const ITERATIONS: usize = 200;
/// Tolerance of convergence, relative to the scale of the pair: the rounding of a distance.
const CONVERGENCE_TOLERANCE: f64 = 4e-16;
/// Distance below which the cores count as touching, relative to the scale of the pair. The direction is then dominated
/// by rounding, and the faces of EPA give a better one.
const CONTACT_TOLERANCE: f64 = 1e-12;

/// Excess over the query bound, relative to the scale of the pair, that exceeds the error of hill climbing.
const EXCESS_TOLERANCE: f64 = 1e-9;

/// Result of GJK.
pub(super) enum GjkResult {
    /// Separated by the gap.
    Apart(Gap),
    /// Farther apart than the query bound.
    Beyond,
    /// Touching or overlapping, at these points.
    Contact(Corner),
}

/// The distance of two cores, unless it is more than `max_distance`.
pub(super) fn distance(pair: &Pair<'_>, max_distance: f64) -> GjkResult {
    let scale = pair.scale();
    let toward = pair.middle();
    let toward = if toward.norm_squared() > 0.0 {
        toward
    } else {
        Vector3::UNITS[0]
    };
    let climbed = pair.is_climbed();
    let mut simplex = Simplex::point(pair.approximate_support(-toward));
    let mut previous_length = f64::INFINITY;
    for _ in 0..ITERATIONS {
        let nearest = simplex.nearest();
        let offset = nearest.difference();
        let length = offset.norm();
        if length <= CONTACT_TOLERANCE * scale {
            return GjkResult::Contact(nearest);
        }
        // A length that does not decrease is at the limit of rounding.
        let stuck = length >= previous_length;
        previous_length = length;
        let normal = face_normal(&simplex, offset);
        let mut corner = pair.approximate_support(-normal);
        // The plane through the support point bounds the distance of A − B from below.
        let mut lower_bound = corner.difference().dot(normal);
        if lower_bound > max_distance + EXCESS_TOLERANCE * scale {
            return GjkResult::Beyond;
        }
        let has_converged = |corner: &Corner, lower_bound: f64| {
            stuck
                || length - lower_bound <= CONVERGENCE_TOLERANCE * scale
                || simplex.corners().contains(corner)
        };
        if climbed && (lower_bound > max_distance || has_converged(&corner, lower_bound)) {
            corner = pair.support(-normal);
            lower_bound = corner.difference().dot(normal);
        }
        if lower_bound > max_distance {
            return GjkResult::Beyond;
        }
        if has_converged(&corner, lower_bound) {
            return GjkResult::Apart(Gap {
                distance: length,
                on_a: nearest.on_a,
                on_b: nearest.on_b,
                normal: -normal,
            });
        }
        simplex = simplex.with(corner);
        if simplex.corners().len() == 4 {
            return GjkResult::Contact(simplex.nearest());
        }
    }
    let nearest = simplex.nearest();
    let offset = nearest.difference();
    GjkResult::Apart(Gap {
        distance: offset.norm(),
        on_a: nearest.on_a,
        on_b: nearest.on_b,
        normal: -face_normal(&simplex, offset),
    })
}

/// Unit direction of `offset`. For a triangle it is the triangle's normal, which keeps its accuracy at small distances.
fn face_normal(simplex: &Simplex, offset: Vector3<f64>) -> Vector3<f64> {
    let direction = offset * offset.norm().recip();
    if let [a, b, c] = simplex.corners() {
        let sides = [b, c].map(|corner| corner.difference() - a.difference());
        let normal = sides[0].cross(sides[1]);
        let area = normal.norm();
        // Slivers, as round bodies cause, have an inaccurate normal.
        if area > 1e-4 * sides[0].norm() * sides[1].norm() {
            let normal = normal * area.recip();
            let normal = if normal.dot(direction) < 0.0 {
                -normal
            } else {
                normal
            };
            if normal.dot(direction) > 0.9 {
                return normal;
            }
        }
    }
    direction
}
