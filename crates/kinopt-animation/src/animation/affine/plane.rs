//! Affine maps of the plane, by section 4 of the paper.

use std::f64::consts::PI;

use glam::{DAffine2, DMat2, DVec2};

use kinopt_kinematics::scalar::elementary;

use super::NotFinite;

/// An affine map of the plane as translation · rotation · stretch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneDecomposition {
    /// Image of the origin.
    pub translation: DVec2,
    /// Rotation nearest to the linear part, radians within [−π, π].
    pub angle: f64,
    /// Symmetric scaling along two orthogonal axes. Positive definite, except that one scale is negative if the map
    /// mirrors.
    pub stretch: DMat2,
}

impl PlaneDecomposition {
    /// Polar decomposition M = R S of the linear part. R rotates by the angle of (m₁₁ + m₂₂, m₂₁ − m₁₂), which makes
    /// RᵀM symmetric.
    ///
    /// # Errors
    /// [`NotFinite`] for an entry that is NaN or infinite.
    pub fn new(map: &DAffine2) -> Result<Self, NotFinite> {
        if !map.is_finite() {
            return Err(NotFinite);
        }
        let [[a, b], [c, d]] = map.matrix2.to_cols_array_2d();
        // Halved to avoid overflow of the sums.
        let angle = elementary::atan2(0.5 * b - 0.5 * c, 0.5 * a + 0.5 * d);
        Ok(Self {
            translation: map.translation,
            angle,
            stretch: rotation_matrix(-angle) * map.matrix2,
        })
    }

    /// The affine map: translation · rotation · stretch.
    #[must_use]
    pub fn compose(&self) -> DAffine2 {
        DAffine2 {
            matrix2: rotation_matrix(self.angle) * self.stretch,
            translation: self.translation,
        }
    }

    /// Interpolates to `other` with `t` in [0, 1]. Translation, stretch and angle are linear; the angle takes the
    /// shorter direction.
    #[must_use]
    pub fn interpolate(&self, other: &Self, t: f64) -> Self {
        let angle_difference = (other.angle - self.angle + PI).rem_euclid(2.0 * PI) - PI;
        Self {
            translation: self.translation * (1.0 - t) + other.translation * t,
            angle: self.angle + t * angle_difference,
            stretch: self.stretch * (1.0 - t) + other.stretch * t,
        }
    }
}

/// Rotation matrix of the plane for an angle in radians.
fn rotation_matrix(angle: f64) -> DMat2 {
    let (sin, cos) = elementary::sin_cos(angle);
    DMat2::from_cols_array(&[cos, sin, -sin, cos])
}

/// Interpolates between two affine maps of the plane with `t` in [0, 1], by [`PlaneDecomposition`].
///
/// # Errors
/// [`NotFinite`] for an entry that is NaN or infinite.
pub fn interpolate_plane_affine(
    from: &DAffine2,
    to: &DAffine2,
    t: f64,
) -> Result<DAffine2, NotFinite> {
    let (from, to) = (PlaneDecomposition::new(from)?, PlaneDecomposition::new(to)?);
    Ok(from.interpolate(&to, t).compose())
}
