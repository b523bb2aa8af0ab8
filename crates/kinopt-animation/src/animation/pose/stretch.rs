//! Accumulated scales of a bone and its ancestors, in the bone's rigid frame.

use glam::{DMat3, DQuat, DVec3, Vec3A};

use super::Mirror;

/// Largest relative difference of the scales along a bone's axes that counts as rounding.
const EVENNESS_TOLERANCE: f64 = 1e-6;
/// Largest relative difference of a rest pose's scales that needs no note. Exporters round by this much. Inverse
/// kinematics corrects such shear all the same.
const NOTED_UNEVENNESS: f64 = 1e-4;

/// Q⁻¹ A of a bone, with the linear part A of its model transform and its rotation Q in the model without scales.
///
/// Even scales commute with rotations and remain diagonal along a chain. An uneven scale shears the bones that rotate
/// below it: their stretch depends on their rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(hidden)]
pub enum Stretch {
    /// Along the bone's own axes; negative if it mirrors.
    Diagonal(DVec3),
    /// With shear.
    Sheared(DMat3),
}

impl Stretch {
    /// No scale.
    #[doc(hidden)]
    pub const NONE: Self = Self::Diagonal(DVec3::ONE);

    /// Stretch of a child. `mirror` is that of this bone's children, `rotation` the child's local unit quaternion,
    /// `scale` the child's scale.
    #[doc(hidden)]
    pub fn below(self, mirror: Mirror, rotation: DQuat, scale: Vec3A) -> Self {
        let scale = scale.as_dvec3();
        match self {
            Self::Diagonal(parent_scale) if is_even(parent_scale) => {
                Self::Diagonal(parent_scale * scale)
            }
            _ => {
                let axes = DMat3::from_quat(mirror.rotation(rotation));
                let local = DMat3::from_quat(rotation) * DMat3::from_diagonal(scale);
                Self::Sheared(axes.transpose() * self.matrix() * local)
            }
        }
    }

    /// The scaled vector of the bone, in the axes of its rigid frame.
    #[doc(hidden)]
    pub fn apply(&self, v: DVec3) -> DVec3 {
        match self {
            Self::Diagonal(scale) => v * *scale,
            Self::Sheared(matrix) => *matrix * v,
        }
    }

    /// Returns true if the absolute scales of all axes are equal.
    pub(crate) fn is_even_scale(scale: Vec3A) -> bool {
        is_even(scale.as_dvec3())
    }

    /// Returns true if the absolute scales of the axes differ by more than exporters round.
    pub(crate) fn is_noted(scale: Vec3A) -> bool {
        unevenness(scale.as_dvec3()) > NOTED_UNEVENNESS
    }

    /// Returns true if bones that rotate below this one keep their lengths.
    #[doc(hidden)]
    pub fn is_even(&self) -> bool {
        matches!(self, Self::Diagonal(scale) if is_even(*scale))
    }

    fn matrix(self) -> DMat3 {
        match self {
            Self::Diagonal(scale) => DMat3::from_diagonal(scale),
            Self::Sheared(matrix) => matrix,
        }
    }
}

/// Returns true if the absolute scales of the axes differ by rounding only.
fn is_even(scale: DVec3) -> bool {
    let sizes = scale.abs();
    sizes.max_element() - sizes.min_element() <= EVENNESS_TOLERANCE * sizes.max_element()
}

/// Largest relative difference of the absolute scales; 0 for a scale of 0.
fn unevenness(scale: DVec3) -> f64 {
    let sizes = scale.abs();
    (sizes.max_element() - sizes.min_element()) / sizes.max_element().max(f64::MIN_POSITIVE)
}
