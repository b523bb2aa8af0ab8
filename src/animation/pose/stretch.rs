//! Scales of a bone and of all bones above it, in the bone's rigid frame.

use glam::{DMat3, DQuat, DVec3, Vec3A};

use super::Mirror;

/// Largest difference of the scales along a bone's axes that counts as rounding, as a share of the largest scale.
const EVEN_WITHIN: f64 = 1e-6;

/// Q⁻¹ A of a bone, with A the linear part of its transform into the model and Q its rotation there without scales.
///
/// Even scales commute with rotations and so stay diagonal down a chain. An uneven scale shears the bones that turn below
/// it: their stretch then depends on how they are turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Stretch {
    /// Along the bone's own axes; negative where it mirrors.
    Diagonal(DVec3),
    /// With shear.
    Sheared(DMat3),
}

impl Stretch {
    /// No scale.
    pub(crate) const NONE: Self = Self::Diagonal(DVec3::ONE);

    /// Of a child: `mirror` is that of this bone's children, `rotation` the child's local rotation of unit length and
    /// `scale` its own scale.
    pub(crate) fn below(self, mirror: Mirror, rotation: DQuat, scale: Vec3A) -> Self {
        let scale = scale.as_dvec3();
        match self {
            Self::Diagonal(above) if is_even(above) => Self::Diagonal(above * scale),
            _ => {
                let turned = DMat3::from_quat(mirror.rotation(rotation));
                let local = DMat3::from_quat(rotation) * DMat3::from_diagonal(scale);
                Self::Sheared(turned.transpose() * self.matrix() * local)
            }
        }
    }

    /// A vector of the bone, scaled, in the axes of its rigid frame.
    pub(crate) fn apply(&self, v: DVec3) -> DVec3 {
        match self {
            Self::Diagonal(scale) => v * *scale,
            Self::Sheared(matrix) => *matrix * v,
        }
    }

    /// Whether a scale is the same along all axes, signs aside.
    pub(crate) fn is_even_scale(scale: Vec3A) -> bool {
        is_even(scale.as_dvec3())
    }

    /// Whether bones that turn below it keep their lengths.
    pub(crate) fn is_even(&self) -> bool {
        matches!(self, Self::Diagonal(scale) if is_even(*scale))
    }

    fn matrix(self) -> DMat3 {
        match self {
            Self::Diagonal(scale) => DMat3::from_diagonal(scale),
            Self::Sheared(matrix) => matrix,
        }
    }
}

/// Whether scales differ along the axes by no more than rounding, signs aside.
fn is_even(scale: DVec3) -> bool {
    let sizes = scale.abs();
    sizes.max_element() - sizes.min_element() <= EVEN_WITHIN * sizes.max_element()
}
