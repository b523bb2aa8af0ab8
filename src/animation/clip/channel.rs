//! What a clip moves and how.

use glam::{Quat, Vec3A};

use crate::animation::curve::KeyedCurve;
use crate::animation::rotation::exponential::turn_about;
use crate::animation::rotation::{EulerOrder, RotationCurve};

/// A curve for one property of one bone; times are in seconds. Weights of morph targets go to
/// [`ClipBuilder::morph_weight`](super::ClipBuilder::morph_weight), because they hang on no bone.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Channel {
    /// Where the bone is in its parent.
    Translation(KeyedCurve<Vec3A>),
    /// How the bone is turned in its parent.
    Rotation(RotationCurve),
    /// How the bone is turned in its parent, as angles.
    Euler(EulerCurve),
    /// How the bone is scaled along its own axes.
    Scale(KeyedCurve<Vec3A>),
}

/// A rotation before · R(angles), whose angles run along a curve. For motion that is authored in
/// angles; they may pass whole turns, which quaternions cannot.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EulerCurve {
    /// The axes of the angles.
    pub order: EulerOrder,
    /// The rotation that the angles follow: where zero angles are.
    pub before: Quat,
    /// The angles in radians, in the order of the axes.
    pub angles: KeyedCurve<Vec3A>,
}

impl EulerCurve {
    /// The rotation at a time in seconds.
    #[must_use]
    pub fn at(&self, time: f32) -> Quat {
        self.rotation(self.angles.at(time))
    }

    /// The rotation of these angles.
    pub(super) fn rotation(&self, angles: Vec3A) -> Quat {
        let axes = self.order.axes().map(|axis| glam::Vec3::AXES[axis]);
        let turns = axes.into_iter().zip(angles.to_array());
        let turned = turns.fold(self.before, |q, (axis, angle)| q * turn_about(axis, angle));
        turned.normalize()
    }
}

impl Channel {
    /// The key times in seconds.
    #[must_use]
    pub fn times(&self) -> &[f32] {
        match self {
            Self::Translation(curve) | Self::Scale(curve) => curve.times(),
            Self::Rotation(curve) => curve.times(),
            Self::Euler(curve) => curve.angles.times(),
        }
    }

    /// The property's name in messages.
    pub(crate) fn property(&self) -> Property {
        match self {
            Self::Translation(_) => Property::Translation,
            Self::Rotation(_) | Self::Euler(_) => Property::Rotation,
            Self::Scale(_) => Property::Scale,
        }
    }
}

/// What of a bone a channel moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Property {
    /// Where it is.
    Translation,
    /// How it is turned, by quaternions or by angles.
    Rotation,
    /// How it is scaled.
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
