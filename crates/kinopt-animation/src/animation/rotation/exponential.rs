//! Exponential and logarithm of rotations, bitwise reproducible on every machine. glam uses the platform's sine and arc
//! tangent.

use glam::{DQuat, DVec3, Quat, Vec3};

use super::AxisAngle;
use kinopt_kinematics::scalar::elementary::{self, single};

/// Rotation about a unit axis by an angle in radians.
pub(crate) fn rotation_about(axis: Vec3, angle: f32) -> Quat {
    let (sin, cos) = single::sin_cos(0.5 * angle);
    Quat::from_vec4((axis * sin).extend(cos))
}

/// [`rotation_about`] in double precision.
pub(crate) fn rotation_about_f64(axis: DVec3, angle: f64) -> DQuat {
    let (sin, cos) = elementary::sin_cos(0.5 * angle);
    DQuat::from_vec4((axis * sin).extend(cos))
}

/// Rotation of a rotation vector, axis × angle in radians.
pub(crate) fn exp(rotation_vector: Vec3) -> Quat {
    let angle = rotation_vector.length();
    match angle > 0.0 {
        true => rotation_about(rotation_vector / angle, angle),
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
pub(crate) fn partial_rotation(rotation: DQuat, fraction: f64) -> DQuat {
    let AxisAngle { axis, angle } = AxisAngle::from_quaternion(rotation);
    rotation_about_f64(axis, fraction * angle)
}
