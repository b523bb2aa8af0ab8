//! Reflections of bones by negative scales.
//!
//! A mirrored bone rotates its children in reflected axes. With D the signs of the ancestors' scales, a local rotation
//! R rotates the rigid bone by D R D.

use glam::{DQuat, DVec3, Quat, Vec3A};

/// Product of the signs of scales along a chain of bones, by axis: a reflection D with D² = 1.
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(hidden)]
pub struct Mirror(DVec3);

impl Mirror {
    /// No reflection.
    #[doc(hidden)]
    pub const NONE: Self = Self(DVec3::ONE);

    /// Mirror of a bone's children: this mirror of the bone with the signs of its scale.
    #[doc(hidden)]
    pub fn below(self, scale: Vec3A) -> Self {
        let sign = |scale: f32| if scale < 0.0 { -1.0 } else { 1.0 };
        Self(self.0 * DVec3::new(sign(scale.x), sign(scale.y), sign(scale.z)))
    }

    /// Composition with the mirror `other` of a chain below.
    pub(crate) fn and(self, other: Self) -> Self {
        Self(self.0 * other.0)
    }

    /// D a det D: the axis of D R D for a rotation R about an axis a.
    pub(crate) fn axis(self, axis: DVec3) -> DVec3 {
        axis * (self.0 * (self.0.x * self.0.y * self.0.z))
    }

    /// D R D: converts a local rotation to that of the rigid bone, and back.
    #[doc(hidden)]
    pub fn rotation(self, q: DQuat) -> DQuat {
        let axis = self.axis(DVec3::new(q.x, q.y, q.z));
        DQuat::from_xyzw(axis.x, axis.y, axis.z, q.w)
    }

    /// [`rotation`](Self::rotation) in single precision.
    pub(crate) fn single(self, q: Quat) -> Quat {
        // Changes of sign are exact.
        self.rotation(q.as_dquat()).as_quat()
    }
}
