//! Dual quaternions in single precision: rigid motions that can be blended.

use std::ops::{Add, Mul};

use glam::{Affine3A, Quat, Vec3, Vec4};

use super::SkinningError;

/// q̂ = r + ε d with r the rotation and d = ½ t r, t the translation as a pure quaternion.
///
/// Kavan, Collins, Žára & O'Sullivan 2008, "Geometric skinning with approximate dual quaternion
/// blending". Unit when it comes from a rigid motion; blends are not, until they are used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DualQuaternion {
    /// The real part x, y, z, w.
    pub real: Vec4,
    /// The dual part x, y, z, w.
    pub dual: Vec4,
}

impl DualQuaternion {
    /// No blend yet.
    pub(super) const ZERO: Self = Self {
        real: Vec4::ZERO,
        dual: Vec4::ZERO,
    };

    /// A turn about the origin, then a shift (in the model's own unit). The quaternion is made of
    /// unit length.
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

    /// The rigid part of a transform whose linear part is a rotation.
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

    /// Moves a point: R p + t, for any length of the real part. Kavan et al. 2008, algorithm 1,
    /// with both divisions by ‖r‖ made one by ‖r‖².
    #[must_use]
    pub fn transform_point(&self, point: Vec3) -> Vec3 {
        let (r, w) = (self.real.truncate(), self.real.w);
        let (d, dw) = (self.dual.truncate(), self.dual.w);
        let twice = 2.0 / self.real.length_squared();
        point + twice * (r.cross(r.cross(point) + w * point) + w * d - dw * r + r.cross(d))
    }

    /// Turns a direction: R v, for any length of the real part.
    #[must_use]
    pub fn transform_vector(&self, vector: Vec3) -> Vec3 {
        let (r, w) = (self.real.truncate(), self.real.w);
        let twice = 2.0 / self.real.length_squared();
        vector + twice * r.cross(r.cross(vector) + w * vector)
    }

    /// The same motion on the other's hemisphere: q̂ and −q̂ move alike, but only neighbours blend
    /// along the short way.
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
