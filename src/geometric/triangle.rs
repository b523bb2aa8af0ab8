//! Triangle of two bones and the line to their target: the law of cosines in space.

use super::linkage::{Span, direction};
use crate::scalar::elementary;
use crate::spatial::Vector3;

/// The pose of two bones that reach for a target.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Triangle {
    /// Position of the joint between the bones.
    pub mid: Vector3<f64>,
    /// The end of the second bone: the target, or the closest point to it that the bones reach.
    pub tip: Vector3<f64>,
    /// Angle at the root from the direction of the target to the first bone, radians within [0, π].
    pub swing: f64,
    /// Angle from the first bone's direction to the second's, radians within [0, π].
    pub turn: f64,
    /// Position of the target relative to the reach of the bones.
    pub span: Span,
}

/// The triangle of two bones of the given lengths from `root` to `target`, with the mid point towards `towards`.
///
/// Only the part of the direction `towards` perpendicular to the line to the target counts.
///
/// In the plane: `cos turn = (d² − ℓ₁² − ℓ₂²) / (2 ℓ₁ ℓ₂)`. With the mid point clockwise of the target (elbow angle
/// +turn) the first bone's heading is that of the target − swing. On the other side it is + swing, with elbow angle
/// −turn. Half-angle forms lose no digits if the bones are almost stretched or folded. Numbers that are not finite give
/// NaN.
#[must_use]
pub fn triangle(
    root: Vector3<f64>,
    [upper, lower]: [f64; 2],
    target: Vector3<f64>,
    towards: Vector3<f64>,
) -> Triangle {
    let way = target - root;
    let distance = way.norm();
    let along = if distance > 0.0 {
        way * (1.0 / distance)
    } else {
        across(towards)
    };
    let (stretched, folded) = (upper + lower, (upper - lower).abs());
    let (span, reached) = if distance > stretched {
        (Span::TooFar(distance - stretched), stretched)
    } else if distance < folded {
        (Span::TooNear(folded - distance), folded)
    } else {
        (Span::Within, distance)
    };

    // tan²(turn/2) = ((ℓ₁ + ℓ₂)² − d²) / (d² − (ℓ₁ − ℓ₂)²)
    let beyond = (stretched - reached) * (stretched + reached);
    let within = (reached - folded) * (reached + folded);
    let (beyond, within) = (beyond.max(0.0).sqrt(), within.max(0.0).sqrt());
    let turn = 2.0 * elementary::atan2(beyond, within);
    // Twice the triangle's area is d · height and half of beyond · within.
    let (ahead, height) = if reached > 0.0 {
        let ahead = ((upper - lower) * stretched + reached * reached) / (2.0 * reached);
        (ahead, 0.5 * beyond * within / reached)
    } else {
        (0.0, upper)
    };
    let aside = towards - along * along.dot(towards);
    let aside = match aside.norm_squared() > 1e-24 * towards.norm_squared() {
        true => direction(aside, aside),
        false => across(along),
    };
    Triangle {
        mid: root + along * ahead + aside * height,
        tip: along.mul_add(reached, root),
        swing: elementary::atan2(height, ahead),
        turn,
        span,
    }
}

/// A unit vector perpendicular to another vector.
pub(super) fn across(vector: Vector3<f64>) -> Vector3<f64> {
    let [x, y, z] = vector.to_array().map(f64::abs);
    let [unit_x, unit_y, unit_z] = Vector3::UNITS;
    let other = match (x <= y && x <= z, y <= z) {
        (true, _) => unit_x,
        (false, true) => unit_y,
        _ => unit_z,
    };
    direction(vector.cross(other), unit_z)
}
