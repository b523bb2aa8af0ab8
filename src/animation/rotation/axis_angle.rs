//! Rotations as an axis and an angle.

use glam::{DMat3, DQuat, DVec3};

use super::exponential::turn_about_exactly;
use crate::scalar::elementary;

/// A turn about an axis. Angles that differ by whole turns, and the opposite axis with the opposite
/// angle, are the same rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisAngle {
    /// Of unit length.
    pub axis: DVec3,
    /// In radians.
    pub angle: f64,
}

impl AxisAngle {
    /// A turn by an angle in radians about an axis of any length; `None` for one without direction.
    #[must_use]
    pub fn about(axis: DVec3, angle: f64) -> Option<Self> {
        let axis = axis.try_normalize()?;
        Some(Self { axis, angle })
    }

    /// The axis and angle of a unit quaternion, the angle within [0, π]. The identity turns by 0
    /// about x.
    #[must_use]
    pub fn from_quaternion(q: DQuat) -> Self {
        let q = if q.w < 0.0 { -q } else { q };
        let v = q.xyz();
        let length = v.length();
        // The arc tangent is exact near 0 and near π, where an arc cosine loses half the digits.
        Self {
            axis: v.try_normalize().unwrap_or(DVec3::X),
            angle: 2.0 * elementary::atan2(length, q.w),
        }
    }

    /// The turn about `a`/‖`a`‖ by ‖`a`‖ radians: axis × angle in three numbers. The zero vector is
    /// the turn by 0 about x.
    #[must_use]
    pub fn from_rotation_vector(a: DVec3) -> Self {
        Self {
            axis: a.try_normalize().unwrap_or(DVec3::X),
            angle: a.length(),
        }
    }

    /// The axis and angle of a rotation matrix.
    #[must_use]
    pub fn from_matrix(rotation: &DMat3) -> Self {
        Self::from_quaternion(DQuat::from_mat3(rotation).normalize())
    }

    getters! {
        /// cos(θ/2) + sin(θ/2) (uₓ i + u_y j + u_z k).
        pub fn to_quaternion(self) -> DQuat = turn_about_exactly(self.axis, self.angle);
        /// The rotation matrix.
        pub fn to_matrix(self) -> DMat3 = DMat3::from_quat(self.to_quaternion());
        /// Axis × angle: the compact form. It is unique below half a turn; there it jumps, as the turn by
        /// π + ε about an axis is that by π − ε about the opposite one.
        pub fn to_rotation_vector(self) -> DVec3 = self.axis * self.angle;
    }
}
