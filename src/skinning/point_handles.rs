//! Point handles: affine transforms about points, with given weights.

use glam::{Affine3A, Mat3A, Vec3, Vec3A};

/// A point that is dragged, turned and stretched, and takes the vertices near it along.
///
/// Handles move vertices exactly as bones do: give their weights as [`SkinWeights`](super::SkinWeights)
/// with a handle for each bone, and [`transforms`](Self::transform) to
/// [`LinearBlend`](super::LinearBlend). That the weights sum to 1 keeps a motion common to all
/// handles exact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointHandle {
    /// Where the handle is at rest, in the model's own unit.
    pub rest: Vec3,
    /// Where it is now.
    pub posed: Vec3,
    /// What it does to its surroundings: rotation, scale, shear about itself.
    pub linear: Mat3A,
}

impl PointHandle {
    /// A handle at rest.
    #[must_use]
    pub fn at(rest: Vec3) -> Self {
        Self {
            rest,
            posed: rest,
            linear: Mat3A::IDENTITY,
        }
    }

    setters! {
        /// The handle dragged to a place.
        pub fn moved_to(mut self, posed: Vec3) { self.posed = posed }
        /// The handle with a linear map about itself.
        pub fn turned_by(mut self, linear: Mat3A) { self.linear = linear }
    }

    /// v → A (v − rest) + posed, as a transform rest model → posed model.
    #[must_use]
    pub fn transform(&self) -> Affine3A {
        Affine3A {
            matrix3: self.linear,
            translation: Vec3A::from(self.posed) - self.linear * Vec3A::from(self.rest),
        }
    }

    /// The transforms of many handles, in order.
    #[must_use]
    pub fn transforms(handles: &[Self]) -> Vec<Affine3A> {
        handles.iter().map(Self::transform).collect()
    }
}
