//! Closed-form covers of capsules by spheres on the axis.

use crate::collision::Ball;
use kinopt_kinematics::bisection::bisect;
use kinopt_kinematics::spatial::{Placement, Vector3};

/// Relative rounding of a length.
const ROUNDING: f64 = 1e-12;

/// Covers a capsule by spheres on its axis: the fewest that protrude at most `max_protrusion` metres, with the smallest
/// radius.
///
/// n spheres, inset by e from both ends of a segment of length ℓ, are g = (ℓ − 2e) / (n − 1) apart. They cover the
/// capsule of radius r if their radius is at least √(r² + g²/4) and at least r + e. The first bound covers the side,
/// where neighbours meet. The second bound covers the poles.
pub(super) fn row(
    radius: f64,
    length: f64,
    max_protrusion: f64,
    link_from_shape: &Placement<f64>,
) -> Vec<Ball> {
    let grown = radius + max_protrusion;
    let max_spacing = 2.0 * (grown * grown - radius * radius).max(0.0).sqrt();
    let gaps = ((length - 2.0 * max_protrusion).max(0.0) / max_spacing).ceil();
    // Limits the number of spheres of an extremely long capsule.
    let gaps = if gaps < 1e6 { gaps } else { 1e6 };
    let (inset, sphere_radius) = balanced_inset(radius, length, gaps);
    let step = if gaps > 0.0 {
        (length - 2.0 * inset) / gaps
    } else {
        0.0
    };
    let first = if gaps > 0.0 {
        inset - length / 2.0
    } else {
        0.0
    };
    let sphere = |k: usize| {
        let z = step * k as f64 + first;
        Ball {
            centre: link_from_shape.apply(Vector3::new(0.0, 0.0, z)),
            radius: sphere_radius,
        }
    };
    (0..=gaps as usize).map(sphere).collect()
}

/// True if the balls on a capsule's axis cover it as a [row] does: each contains a section of the capsule.
pub(super) fn covers_capsule(
    balls: &[Ball],
    radius: f64,
    length: f64,
    link_from_shape: &Placement<f64>,
) -> bool {
    let rounding = ROUNDING * (radius + length + link_from_shape.translation.norm());
    let shape_from_link = link_from_shape.inverse();
    let on_axis = balls.iter().filter_map(|ball| {
        let centre = shape_from_link.apply(ball.centre);
        let axis_distance = (centre.x * centre.x + centre.y * centre.y).sqrt();
        (axis_distance <= rounding).then_some((centre.z, ball.radius + rounding))
    });
    let on_axis: Vec<(f64, f64)> = on_axis.collect();
    let ends = [-0.5 * length, 0.5 * length];
    let is_covered_end =
        |end: f64| (on_axis.iter()).any(|(z, ball)| (z - end).abs() + radius <= *ball);
    let mut intervals: Vec<[f64; 2]> = (on_axis.iter())
        .filter(|(_, ball)| *ball >= radius)
        .map(|(z, ball)| (z, (ball * ball - radius * radius).sqrt()))
        .map(|(z, half)| [z - half, z + half])
        .collect();
    intervals.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let covered_end = intervals.iter().fold(ends[0], |covered_end, interval| {
        match interval[0] <= covered_end + rounding {
            true => covered_end.max(interval[1]),
            false => covered_end,
        }
    });
    ends.into_iter().all(is_covered_end) && covered_end + rounding >= ends[1]
}

/// The inset at which sides and poles need the same radius, and that radius.
fn balanced_inset(radius: f64, length: f64, gaps: f64) -> (f64, f64) {
    if gaps == 0.0 {
        return (length / 2.0, radius + length / 2.0);
    }
    let side = |inset: f64| {
        let half = (length - 2.0 * inset) / gaps / 2.0;
        (half * half + radius * radius).sqrt()
    };
    let poles = |inset: f64| radius + inset;
    let inset = bisect(length / 2.0, 0.0, 60, |inset| side(inset) <= poles(inset));
    let sphere_radius = side(inset).max(poles(inset));
    (inset, sphere_radius * (1.0 + 4.0 * f64::EPSILON))
}
