//! Rotations from axes and angles and back, as glam has them but with the same bits on every
//! machine: glam asks the operating system for sine and arc tangent.

use glam::{DQuat, DVec3, Quat, Vec3};

use super::AxisAngle;
use crate::scalar::elementary::{self, single};

/// The turn about a unit axis by an angle in radians.
pub(crate) fn turn_about(axis: Vec3, angle: f32) -> Quat {
    let (sin, cos) = single::sin_cos(0.5 * angle);
    Quat::from_vec4((axis * sin).extend(cos))
}

/// [`turn_about`] in double precision.
pub(crate) fn turn_about_exactly(axis: DVec3, angle: f64) -> DQuat {
    let (sin, cos) = elementary::sin_cos(0.5 * angle);
    DQuat::from_vec4((axis * sin).extend(cos))
}

/// The rotation by a rotation vector (axis × angle in radians).
pub(crate) fn exp(turn: Vec3) -> Quat {
    let angle = turn.length();
    match angle > 0.0 {
        true => turn_about(turn / angle, angle),
        false => Quat::IDENTITY,
    }
}

/// The rotation vector (axis × angle in radians) of a unit quaternion; longer than π where w is
/// negative.
pub(crate) fn log(q: Quat) -> Vec3 {
    let length = q.xyz().length();
    match length > 0.0 {
        true => q.xyz() * (2.0 * single::atan2(length, q.w) / length),
        false => Vec3::ZERO,
    }
}

/// The share of a turn along its shorter arc.
pub(crate) fn share_of(turn: DQuat, share: f64) -> DQuat {
    let AxisAngle { axis, angle } = AxisAngle::from_quaternion(turn);
    turn_about_exactly(axis, share * angle)
}
