//! Rotations as axis and angle.

use glam::{DMat3, DQuat, DVec3};

use super::exponential::rotation_about_f64;
use crate::scalar::elementary;

/// Rotation about an axis. Angles that differ by full turns describe one rotation, as does the opposite axis with the
/// opposite angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisAngle {
    /// Axis of unit length.
    pub axis: DVec3,
    /// Angle, radians.
    pub angle: f64,
}

impl AxisAngle {
    /// Rotation by an angle in radians about an axis of any length; `None` for an axis without direction.
    #[must_use]
    pub fn about(axis: DVec3, angle: f64) -> Option<Self> {
        let axis = axis.try_normalize()?;
        Some(Self { axis, angle })
    }

    /// Axis and angle of a unit quaternion, with the angle within [0, π]. The identity has angle 0 about x.
    #[must_use]
    pub fn from_quaternion(q: DQuat) -> Self {
        let q = if q.w < 0.0 { -q } else { q };
        let v = q.xyz();
        let length = v.length();
        // The arc tangent is accurate near 0 and π, where an arc cosine loses half the digits.
        Self {
            axis: v.try_normalize().unwrap_or(DVec3::X),
            angle: 2.0 * elementary::atan2(length, q.w),
        }
    }

    /// Rotation by ‖`a`‖ radians about `a`/‖`a`‖. The zero vector gives angle 0 about x.
    #[must_use]
    pub fn from_rotation_vector(a: DVec3) -> Self {
        Self {
            axis: a.try_normalize().unwrap_or(DVec3::X),
            angle: a.length(),
        }
    }

    /// Axis and angle of a rotation matrix.
    #[must_use]
    pub fn from_matrix(rotation: &DMat3) -> Self {
        Self::from_quaternion(DQuat::from_mat3(rotation).normalize())
    }

    /// Unit quaternion cos(θ/2) + sin(θ/2) (uₓ i + u_y j + u_z k).
    #[must_use]
    pub fn to_quaternion(self) -> DQuat {
        rotation_about_f64(self.axis, self.angle)
    }

    /// Rotation matrix.
    #[must_use]
    pub fn to_matrix(self) -> DMat3 {
        DMat3::from_quat(self.to_quaternion())
    }

    /// Rotation vector, axis × angle. It is unique below half a turn. At half a turn it is discontinuous: π + ε
    /// about an axis equals π − ε about the opposite axis.
    #[must_use]
    pub fn to_rotation_vector(self) -> DVec3 {
        self.axis * self.angle
    }
}
