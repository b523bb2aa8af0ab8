//! A rigid placement: where one frame stands in another.

use std::ops::Mul;

use super::{Matrix3, Quaternion, Vector3, rotation_exp};
use crate::scalar::Scalar;

/// A rigid motion `x ↦ rotation · x + translation`. Names say both frames: `world_from_tip` maps
/// tip coordinates to world coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Placement<S> {
    /// Orthonormal, determinant +1.
    pub rotation: Matrix3<S>,
    /// In metres (or in the model's own unit for rigs).
    pub translation: Vector3<S>,
}

impl<S: Scalar> Placement<S> {
    /// A placement of its two parts.
    #[inline(always)]
    pub fn new(rotation: Matrix3<S>, translation: Vector3<S>) -> Self {
        Self {
            rotation,
            translation,
        }
    }

    /// The identity.
    #[inline(always)]
    pub fn identity() -> Self {
        Self::new(Matrix3::identity(), Vector3::zero())
    }

    /// A pure translation.
    #[inline(always)]
    pub fn translation(by: Vector3<S>) -> Self {
        Self::new(Matrix3::identity(), by)
    }

    /// A constant placement.
    #[inline(always)]
    pub fn constant(value: &Placement<f64>) -> Self {
        Self::new(
            Matrix3::constant(value.rotation),
            Vector3::constant(value.translation),
        )
    }

    /// The placement that undoes this one.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn inverse(self) -> Self {
        let rotation = self.rotation.transpose();
        Self::new(rotation, -(rotation * self.translation))
    }

    /// Maps a point.
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
    /// The placement at a share of the motion to another one: on a straight line, with one axis of rotation.
    pub(crate) fn interpolated(&self, to: &Self, share: f64) -> Self {
        let turn = Quaternion::from_matrix(&(self.rotation.transpose() * to.rotation)).log();
        let way = to.translation - self.translation;
        Self::new(
            self.rotation * rotation_exp(turn * share),
            self.translation + way * share,
        )
    }

    /// The same placement with the rotation next to its own, if that is off by more than rounding
    /// leaves in numbers written with 17 digits; those keep their bits.
    pub(crate) fn made_rigid(self) -> Self {
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
