//! Exponential and logarithm of rotations, bitwise reproducible on every machine. glam uses the platform's sine and arc
//! tangent.

use glam::{DQuat, DVec3, Quat, Vec3};

use super::AxisAngle;
use crate::scalar::elementary::{self, single};

/// Rotation about a unit axis by an angle in radians.
pub(crate) fn turn_about(axis: Vec3, angle: f32) -> Quat {
    let (sin, cos) = single::sin_cos(0.5 * angle);
    Quat::from_vec4((axis * sin).extend(cos))
}

/// [`turn_about`] in double precision.
pub(crate) fn turn_about_exactly(axis: DVec3, angle: f64) -> DQuat {
    let (sin, cos) = elementary::sin_cos(0.5 * angle);
    DQuat::from_vec4((axis * sin).extend(cos))
}

/// Rotation of a rotation vector, axis × angle in radians.
pub(crate) fn exp(turn: Vec3) -> Quat {
    let angle = turn.length();
    match angle > 0.0 {
        true => turn_about(turn / angle, angle),
        false => Quat::IDENTITY,
    }
}

/// Rotation vector, axis × angle in radians, of a unit quaternion. Its length exceeds π if w is negative.
pub(crate) fn log(q: Quat) -> Vec3 {
    let length = q.xyz().length();
    match length > 0.0 {
        true => q.xyz() * (2.0 * single::atan2(length, q.w) / length),
        false => Vec3::ZERO,
    }
}

/// Fraction of a rotation along its shorter arc.
pub(crate) fn share_of(turn: DQuat, share: f64) -> DQuat {
    let AxisAngle { axis, angle } = AxisAngle::from_quaternion(turn);
    turn_about_exactly(axis, share * angle)
}
