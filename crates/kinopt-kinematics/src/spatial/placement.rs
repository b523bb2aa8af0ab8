//! Rigid placement: the pose of one frame in another.

use std::ops::Mul;

use super::{Matrix3, Quaternion, Vector3, rotation_exp};
use crate::scalar::Scalar;

/// A rigid motion `x ↦ rotation · x + translation`.
///
/// Variable names contain both frames: `world_from_tip` maps tip coordinates to world coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Placement<S> {
    /// Orthonormal matrix with determinant +1.
    pub rotation: Matrix3<S>,
    /// Translation in metres (for rigs: in the model's unit).
    pub translation: Vector3<S>,
}

impl<S: Scalar> Placement<S> {
    /// A placement from its rotation and translation.
    #[inline(always)]
    pub fn new(rotation: Matrix3<S>, translation: Vector3<S>) -> Self {
        Self {
            rotation,
            translation,
        }
    }

    /// The identity placement.
    #[inline(always)]
    pub fn identity() -> Self {
        Self::new(Matrix3::identity(), Vector3::zero())
    }

    /// A pure translation.
    #[inline(always)]
    pub fn translation(offset: Vector3<S>) -> Self {
        Self::new(Matrix3::identity(), offset)
    }

    /// A placement whose derivatives are zero, the same in every lane.
    #[inline(always)]
    pub fn constant(value: &Placement<f64>) -> Self {
        Self::new(
            Matrix3::constant(value.rotation),
            Vector3::constant(value.translation),
        )
    }

    /// The inverse placement.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn inverse(self) -> Self {
        let rotation = self.rotation.transpose();
        Self::new(rotation, -(rotation * self.translation))
    }

    /// Maps a point: `rotation · point + translation`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn apply(&self, point: Vector3<S>) -> Vector3<S> {
        self.rotation.z.mul_add(
            point.z,
            self.rotation
                .y
                .mul_add(point.y, self.rotation.x.mul_add(point.x, self.translation)),
        )
    }
}

impl Placement<f64> {
    /// Interpolates to another placement, from 0 (`self`) to 1 (`to`): along a straight line, about one axis of
    /// rotation by the smaller angle.
    #[must_use]
    pub fn interpolated(&self, to: &Self, share: f64) -> Self {
        let rotation_vector =
            Quaternion::from_matrix(&(self.rotation.transpose() * to.rotation)).log();
        let offset = to.translation - self.translation;
        Self::new(
            self.rotation * rotation_exp(rotation_vector * share),
            self.translation + offset * share,
        )
    }

    /// The placement with its rotation replaced by the nearest exact rotation.
    ///
    /// Rotations within the rounding of numbers written with 17 digits stay bitwise unchanged.
    #[doc(hidden)]
    pub fn made_rigid(self) -> Self {
        const ROUNDING: f64 = 1e-14;
        if self.check_rigid(ROUNDING).is_ok() {
            return self;
        }
        let Quaternion { w, v } = Quaternion::from_matrix(&self.rotation);
        let scale = 1.0 / (w * w + v.norm_squared()).sqrt();
        let unit = Quaternion {
            w: w * scale,
            v: v * scale,
        };
        Self::new(unit.to_matrix(), self.translation)
    }
}

impl<S: Scalar> Mul for Placement<S> {
    type Output = Self;
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn mul(self, other: Self) -> Self {
        Self::new(
            self.rotation * other.rotation,
            self.apply(other.translation),
        )
    }
}
