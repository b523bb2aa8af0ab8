//! Rows of spheres along capsules, in closed form.

use crate::collision::Ball;
use crate::spatial::{Placement, Vector3};

/// Covers a capsule by spheres on its axis, as few as stick out no further than `overhang`, and as small as they
/// may be then.
///
/// n spheres inset by e from both ends of a segment of length ℓ stand g = (ℓ − 2e) / (n − 1) apart. They cover the
/// capsule of radius r if theirs is at least √(r² + g²/4), where neighbours meet on its side, and r + e, at its
/// poles.
pub(super) fn row(
    radius: f64,
    length: f64,
    overhang: f64,
    link_from_shape: &Placement<f64>,
) -> Vec<Ball> {
    let grown = radius + overhang;
    let apart = 2.0 * (grown * grown - radius * radius).max(0.0).sqrt();
    let between = ((length - 2.0 * overhang).max(0.0) / apart).ceil();
    // A capsule of nearly endless length would need as many.
    let between = if between < 1e6 { between } else { 1e6 };
    let (inset, needed) = evened(radius, length, between);
    let step = if between > 0.0 {
        (length - 2.0 * inset) / between
    } else {
        0.0
    };
    let first = if between > 0.0 {
        inset - length / 2.0
    } else {
        0.0
    };
    let sphere = |k: usize| {
        let z = step * k as f64 + first;
        Ball {
            centre: link_from_shape.apply(Vector3::new(0.0, 0.0, z)),
            radius: needed,
        }
    };
    (0..=between as usize).map(sphere).collect()
}

/// The inset at which the sides and the poles need the same radius, and that radius.
fn evened(radius: f64, length: f64, between: f64) -> (f64, f64) {
    if between == 0.0 {
        return (length / 2.0, radius + length / 2.0);
    }
    let side = |inset: f64| {
        let half = (length - 2.0 * inset) / between / 2.0;
        (half * half + radius * radius).sqrt()
    };
    let (mut low, mut high) = (0.0, length / 2.0);
    for _ in 0..60 {
        let middle = (low + high) / 2.0;
        match side(middle) > radius + middle {
            true => low = middle,
            false => high = middle,
        }
    }
    (
        high,
        side(high).max(radius + high) * (1.0 + 4.0 * f64::EPSILON),
    )
}
