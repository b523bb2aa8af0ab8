//! Triangle of two bones and the line to their target: the law of cosines in space.

use super::linkage::{Span, direction};
use kinopt_kinematics::scalar::elementary;
use kinopt_kinematics::spatial::Vector3;

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
    let offset = target - root;
    let distance = offset.norm();
    let axis = if distance > 0.0 {
        offset * (1.0 / distance)
    } else {
        perpendicular(towards)
    };
    let (max_reach, min_reach) = (upper + lower, (upper - lower).abs());
    let (span, distance_reached) = if distance > max_reach {
        (Span::TooFar(distance - max_reach), max_reach)
    } else if distance < min_reach {
        (Span::TooNear(min_reach - distance), min_reach)
    } else {
        (Span::Within, distance)
    };

    // tan²(turn/2) = ((ℓ₁ + ℓ₂)² − d²) / (d² − (ℓ₁ − ℓ₂)²)
    let stretch_term = (max_reach - distance_reached) * (max_reach + distance_reached);
    let fold_term = (distance_reached - min_reach) * (distance_reached + min_reach);
    let (stretch_term, fold_term) = (stretch_term.max(0.0).sqrt(), fold_term.max(0.0).sqrt());
    let turn = 2.0 * elementary::atan2(stretch_term, fold_term);
    // Twice the triangle's area is d · height and half of stretch_term · fold_term.
    let (axial, height) = if distance_reached > 0.0 {
        let axial = ((upper - lower) * max_reach + distance_reached * distance_reached)
            / (2.0 * distance_reached);
        (axial, 0.5 * stretch_term * fold_term / distance_reached)
    } else {
        (0.0, upper)
    };
    let side = towards - axis * axis.dot(towards);
    let side = match side.norm_squared() > 1e-24 * towards.norm_squared() {
        true => direction(side, side),
        false => perpendicular(axis),
    };
    Triangle {
        mid: root + axis * axial + side * height,
        tip: axis.mul_add(distance_reached, root),
        swing: elementary::atan2(height, axial),
        turn,
        span,
    }
}

/// A unit vector perpendicular to another vector.
pub(super) fn perpendicular(vector: Vector3<f64>) -> Vector3<f64> {
    let [x, y, z] = vector.to_array().map(f64::abs);
    let [unit_x, unit_y, unit_z] = Vector3::UNITS;
    let other = match (x <= y && x <= z, y <= z) {
        (true, _) => unit_x,
        (false, true) => unit_y,
        _ => unit_z,
    };
    direction(vector.cross(other), unit_z)
}
