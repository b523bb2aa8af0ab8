//! Point handles: affine transforms about points, with given weights.

use glam::{Affine3A, Mat3A, Vec3, Vec3A};

/// A point handle: its affine transform moves the vertices that its weights select.
///
/// Handles deform vertices as bones do. Pass their weights as [`SkinWeights`](super::SkinWeights), with one handle per
/// bone, and their [`transforms`](Self::transform) to [`LinearBlend`](super::LinearBlend). Weights that sum to 1 keep a
/// common motion of all handles exact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointHandle {
    /// Position at rest, in the model's unit.
    pub rest: Vec3,
    /// Posed position, in the model's unit.
    pub posed: Vec3,
    /// Linear map about the handle: rotation, scale, shear.
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

    /// Sets the posed position.
    #[must_use]
    pub fn moved_to(mut self, posed: Vec3) -> Self {
        self.posed = posed;
        self
    }

    /// Sets the linear map about the handle.
    #[must_use]
    pub fn turned_by(mut self, linear: Mat3A) -> Self {
        self.linear = linear;
        self
    }

    /// The transform rest model → posed model: v → A (v − rest) + posed.
    #[must_use]
    pub fn transform(&self) -> Affine3A {
        Affine3A {
            matrix3: self.linear,
            translation: Vec3A::from(self.posed) - self.linear * Vec3A::from(self.rest),
        }
    }

    /// The transforms of several handles, in order.
    #[must_use]
    pub fn transforms(handles: &[Self]) -> Vec<Affine3A> {
        handles.iter().map(Self::transform).collect()
    }
}
