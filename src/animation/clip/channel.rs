//! Channels: curves for the properties of bones.

use glam::{Quat, Vec3A};

use crate::animation::rotation::exponential::rotation_about;
use crate::animation::rotation::{EulerOrder, RotationCurve};
use crate::curve::KeyedCurve;

/// Curve for one property of one bone; times are in seconds. Morph target weights belong to no bone; use
/// [`ClipBuilder::morph_weight`](super::ClipBuilder::morph_weight).
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Channel {
    /// Translation in the parent's frame.
    Translation(KeyedCurve<Vec3A>),
    /// Rotation in the parent's frame.
    Rotation(RotationCurve),
    /// Rotation in the parent's frame, as Euler angles.
    Euler(EulerCurve),
    /// Scale along the bone's own axes.
    Scale(KeyedCurve<Vec3A>),
}

/// Rotation `before` · R(angles), with angles along a curve. Angles may exceed full turns, which quaternions cannot
/// represent.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EulerCurve {
    /// Axis order of the angles.
    pub order: EulerOrder,
    /// Rotation that precedes the angles; the value at zero angles.
    pub before: Quat,
    /// Angles in radians, in axis order.
    pub angles: KeyedCurve<Vec3A>,
}

impl EulerCurve {
    /// Rotation at a time in seconds.
    #[must_use]
    pub fn at(&self, time: f32) -> Quat {
        self.rotation(self.angles.at(time))
    }

    /// Rotation of the given angles in radians.
    pub(super) fn rotation(&self, angles: Vec3A) -> Quat {
        let axes = self.order.axes().map(|axis| glam::Vec3::AXES[axis]);
        let axes_and_angles = axes.into_iter().zip(angles.to_array());
        let rotation = axes_and_angles.fold(self.before, |q, (axis, angle)| {
            q * rotation_about(axis, angle)
        });
        rotation.normalize()
    }
}

impl Channel {
    /// Key times in seconds.
    #[must_use]
    pub fn times(&self) -> &[f32] {
        match self {
            Self::Translation(curve) | Self::Scale(curve) => curve.times(),
            Self::Rotation(curve) => curve.times(),
            Self::Euler(curve) => curve.angles.times(),
        }
    }

    /// Property name for messages.
    pub(crate) fn property(&self) -> Property {
        match self {
            Self::Translation(_) => Property::Translation,
            Self::Rotation(_) | Self::Euler(_) => Property::Rotation,
            Self::Scale(_) => Property::Scale,
        }
    }
}

/// Property of a bone that a channel animates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Property {
    /// Translation.
    Translation,
    /// Rotation, by quaternions or Euler angles.
    Rotation,
    /// Scale.
    Scale,
}

impl std::fmt::Display for Property {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Translation => "translation",
            Self::Rotation => "rotation",
            Self::Scale => "scale",
        })
    }
}
