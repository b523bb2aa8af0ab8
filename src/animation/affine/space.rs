//! Affine maps of space.

use glam::{DAffine3, DMat3, DQuat, DVec3};
use nalgebra as na;

use crate::animation::rotation::exponential::share_of;
use crate::spatial::Polar;

/// An affine map as translation · rotation · stretch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decomposition {
    /// Where the origin goes.
    pub translation: DVec3,
    /// The rotation nearest to the linear part (to its negative, where that mirrors).
    pub rotation: DQuat,
    /// Symmetric: scales along three orthogonal axes. Positive for maps that do not mirror, negative
    /// for those that do. Diagonal where the map scales along the coordinate axes before it turns.
    pub stretch: DMat3,
}

/// An entry of the map is NaN or infinite.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the affine map has an entry that is not finite")]
pub struct NotFinite;

impl Decomposition {
    /// The polar decomposition M = Q S of the linear part, by its singular values. Singular maps have
    /// one as well.
    ///
    /// # Errors
    /// [`NotFinite`].
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

    /// The affine map again.
    #[must_use]
    pub fn compose(&self) -> DAffine3 {
        DAffine3 {
            matrix3: DMat3::from_quat(self.rotation) * self.stretch,
            translation: self.translation,
        }
    }

    /// The share `t` of the way to another one: translation and stretch straight, the rotation along
    /// the shorter arc.
    #[must_use]
    pub fn interpolate(&self, other: &Self, t: f64) -> Self {
        let turn = self.rotation.conjugate() * other.rotation;
        Self {
            translation: self.translation * (1.0 - t) + other.translation * t,
            rotation: (self.rotation * share_of(turn, t)).normalize(),
            stretch: self.stretch * (1.0 - t) + other.stretch * t,
        }
    }
}

/// The share `t` of the way from one affine map to another, by [`Decomposition`].
///
/// # Errors
/// A map with an entry that is not finite.
pub fn interpolate_affine(from: &DAffine3, to: &DAffine3, t: f64) -> Result<DAffine3, NotFinite> {
    let (from, to) = (Decomposition::new(from)?, Decomposition::new(to)?);
    Ok(from.interpolate(&to, t).compose())
}
