//! A rigid placement: where one frame stands in another.

use std::ops::Mul;

use super::{Matrix3, Quaternion, Vector3};
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
    /// Whether this is a rigid motion: all finite, RᵀR the identity within `tolerance` entry by
    /// entry, determinant +1.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub fn check_rigid(&self, tolerance: f64) -> Result<(), &'static str> {
        let Matrix3 { x, y, z } = self.rotation;
        let entries = [x, y, z, self.translation].map(Vector3::to_array);
        if entries.iter().flatten().any(|entry| !entry.is_finite()) {
            return Err("it has an entry that is not finite");
        }
        let unit = [x, y, z].map(|c| (c.norm_squared() - 1.0).abs());
        let orthogonal = [x.dot(y), y.dot(z), z.dot(x)].map(f64::abs);
        if unit
            .iter()
            .chain(&orthogonal)
            .any(|&error| error > tolerance)
        {
            return Err("its rotation is not orthonormal");
        }
        if x.cross(y).dot(z) < 0.0 {
            return Err("its rotation mirrors");
        }
        Ok(())
    }
}

impl Placement<f64> {
    /// The same placement with the rotation next to its own, if that is off by more than rounding
    /// leaves in numbers written with 17 digits; those keep their bits.
    pub(crate) fn made_rigid(self) -> Self {
        const ROUNDING: f64 = 1e-14;
        if self.check_rigid(ROUNDING).is_ok() {
            return self;
        }
        let Quaternion { w, v } = Quaternion::from_matrix(&self.rotation);
        let scale = 1.0 / w.mul_add(w, v.norm_squared()).sqrt();
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
