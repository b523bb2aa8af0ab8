//! Affine maps of space.

use glam::{DAffine3, DMat3, DQuat, DVec3};
use nalgebra as na;

use crate::animation::rotation::exponential::partial_rotation;
use kinopt_kinematics::spatial::Polar;

/// An affine map as translation · rotation · stretch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decomposition {
    /// Image of the origin.
    pub translation: DVec3,
    /// Rotation nearest to the linear part, or to its negative if the map mirrors.
    pub rotation: DQuat,
    /// Symmetric scaling along three orthogonal axes. Positive definite, or negative definite if the map mirrors.
    /// Diagonal if the map scales along the coordinate axes and then rotates.
    pub stretch: DMat3,
}

/// Error of an affine map with an entry that is NaN or infinite.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("affine map: an entry is NaN or infinite; all entries must be finite")]
pub struct NotFinite;

impl Decomposition {
    /// Polar decomposition M = Q S of the linear part by its singular values. Singular maps are decomposed as well.
    ///
    /// # Errors
    /// [`NotFinite`] for an entry that is NaN or infinite.
    pub fn new(map: &DAffine3) -> Result<Self, NotFinite> {
        let linear = na::Matrix3::from_column_slice(&map.matrix3.to_cols_array());
        let polar = Polar::new(&linear).filter(|_| map.is_finite());
        let Polar {
            rotation, stretch, ..
        } = polar.ok_or(NotFinite)?;
        let columns = |m: na::Matrix3<f64>| DMat3::from_cols_slice(m.as_slice());
        Ok(Self {
            translation: map.translation,
            rotation: DQuat::from_mat3(&columns(rotation)).normalize(),
            stretch: columns(stretch),
        })
    }

    /// The affine map: translation · rotation · stretch.
    #[must_use]
    pub fn compose(&self) -> DAffine3 {
        DAffine3 {
            matrix3: DMat3::from_quat(self.rotation) * self.stretch,
            translation: self.translation,
        }
    }

    /// Interpolates to `other` with `t` in [0, 1]. Translation and stretch are linear; the rotation takes the shorter
    /// arc.
    #[must_use]
    pub fn interpolate(&self, other: &Self, t: f64) -> Self {
        let relative_rotation = self.rotation.conjugate() * other.rotation;
        Self {
            translation: self.translation * (1.0 - t) + other.translation * t,
            rotation: (self.rotation * partial_rotation(relative_rotation, t)).normalize(),
            stretch: self.stretch * (1.0 - t) + other.stretch * t,
        }
    }
}

/// Interpolates between two affine maps with `t` in [0, 1], by [`Decomposition`].
///
/// # Errors
/// [`NotFinite`] for an entry that is NaN or infinite.
pub fn interpolate_affine(from: &DAffine3, to: &DAffine3, t: f64) -> Result<DAffine3, NotFinite> {
    let (from, to) = (Decomposition::new(from)?, Decomposition::new(to)?);
    Ok(from.interpolate(&to, t).compose())
}
