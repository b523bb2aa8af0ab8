//! Dual quaternions in single precision: rigid motions for blending.

use std::ops::{Add, Mul};

use glam::{Affine3A, Quat, Vec3, Vec4};

use super::SkinningError;

/// Dual quaternion q̂ = r + ε d. r is the rotation and d = ½ t r, with the translation t as a pure quaternion.
///
/// Source: Kavan, Collins, Žára & O'Sullivan 2008, "Geometric skinning with approximate dual quaternion blending".
/// Rigid motions give unit dual quaternions; blends of them have other lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DualQuaternion {
    /// Real part x, y, z, w.
    pub real: Vec4,
    /// Dual part x, y, z, w.
    pub dual: Vec4,
}

impl DualQuaternion {
    /// The empty blend.
    pub(super) const ZERO: Self = Self {
        real: Vec4::ZERO,
        dual: Vec4::ZERO,
    };

    /// A rotation about the origin followed by a translation in the model's unit. The quaternion is normalised.
    ///
    /// # Errors
    /// The quaternion is zero or not finite.
    pub fn from_rotation_translation(
        rotation: Quat,
        translation: Vec3,
    ) -> Result<Self, SkinningError> {
        let length = rotation.length();
        if !(length.is_finite() && length > 0.0) {
            let [x, y, z, w] = rotation.to_array();
            return Err(SkinningError::ZeroQuaternion { w, x, y, z });
        }
        Ok(Self::of_unit(rotation / length, translation))
    }

    /// The rigid motion of a transform whose linear part is a rotation.
    pub(super) fn of_rigid(transform: &Affine3A) -> Self {
        let rotation = Quat::from_mat3a(&transform.matrix3).normalize();
        Self::of_unit(rotation, transform.translation.into())
    }

    fn of_unit(rotation: Quat, translation: Vec3) -> Self {
        let t = Quat::from_xyzw(translation.x, translation.y, translation.z, 0.0);
        Self {
            real: rotation.into(),
            dual: Vec4::from(t * rotation) * 0.5,
        }
    }

    /// Transforms a point to R p + t, for any length of the real part. Source: Kavan et al. 2008, algorithm 1, with one
    /// division by ‖r‖² instead of two by ‖r‖.
    #[must_use]
    pub fn transform_point(&self, point: Vec3) -> Vec3 {
        let (r, w) = (self.real.truncate(), self.real.w);
        let (d, dw) = (self.dual.truncate(), self.dual.w);
        let twice = 2.0 / self.real.length_squared();
        point + twice * (r.cross(r.cross(point) + w * point) + w * d - dw * r + r.cross(d))
    }

    /// Transforms a direction to R v, for any length of the real part.
    #[must_use]
    pub fn transform_vector(&self, vector: Vec3) -> Vec3 {
        let (r, w) = (self.real.truncate(), self.real.w);
        let twice = 2.0 / self.real.length_squared();
        vector + twice * r.cross(r.cross(vector) + w * vector)
    }

    /// The dual quaternion of the same motion on the hemisphere of `pivot`. q̂ and −q̂ are the same motion, but
    /// blending takes the short arc only within one hemisphere.
    pub(super) fn towards(self, pivot: Self) -> Self {
        if self.real.dot(pivot.real) < 0.0 {
            self * -1.0
        } else {
            self
        }
    }
}

impl Add for DualQuaternion {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            real: self.real + other.real,
            dual: self.dual + other.dual,
        }
    }
}

impl Mul<f32> for DualQuaternion {
    type Output = Self;

    fn mul(self, factor: f32) -> Self {
        Self {
            real: self.real * factor,
            dual: self.dual * factor,
        }
    }
}
