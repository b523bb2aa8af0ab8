//! Affine maps of the plane (the paper's section 4).

use std::f64::consts::PI;

use glam::{DAffine2, DMat2, DVec2};

use crate::scalar::elementary;

use super::NotFinite;

/// An affine map of the plane as translation · rotation · stretch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneDecomposition {
    /// Where the origin goes.
    pub translation: DVec2,
    /// The rotation nearest to the linear part, in radians within [−π, π].
    pub angle: f64,
    /// Symmetric: scales along two orthogonal axes. Positive for maps that do not mirror; one scale is
    /// negative for those that do.
    pub stretch: DMat2,
}

impl PlaneDecomposition {
    /// The polar decomposition M = R S of the linear part: R turns by the angle of
    /// (m₁₁ + m₂₂, m₂₁ − m₁₂), which makes RᵀM symmetric.
    ///
    /// # Errors
    /// [`NotFinite`].
    pub fn new(map: &DAffine2) -> Result<Self, NotFinite> {
        if !map.is_finite() {
            return Err(NotFinite);
        }
        let [[a, b], [c, d]] = map.matrix2.to_cols_array_2d();
        // Halves, so that no sum overflows.
        let angle = elementary::atan2(0.5 * b - 0.5 * c, 0.5 * a + 0.5 * d);
        Ok(Self {
            translation: map.translation,
            angle,
            stretch: turned(-angle) * map.matrix2,
        })
    }

    /// The affine map again.
    #[must_use]
    pub fn compose(&self) -> DAffine2 {
        DAffine2 {
            matrix2: turned(self.angle) * self.stretch,
            translation: self.translation,
        }
    }

    /// The share `t` of the way to another one: translation, stretch and the angle straight, the
    /// angle the shorter way round.
    #[must_use]
    pub fn interpolate(&self, other: &Self, t: f64) -> Self {
        let turn = (other.angle - self.angle + PI).rem_euclid(2.0 * PI) - PI;
        Self {
            translation: self.translation * (1.0 - t) + other.translation * t,
            angle: self.angle + t * turn,
            stretch: self.stretch * (1.0 - t) + other.stretch * t,
        }
    }
}

/// The rotation of the plane by an angle in radians.
fn turned(angle: f64) -> DMat2 {
    let (sin, cos) = elementary::sin_cos(angle);
    DMat2::from_cols_array(&[cos, sin, -sin, cos])
}

/// The share `t` of the way from one affine map of the plane to another, by [`PlaneDecomposition`].
///
/// # Errors
/// A map with an entry that is not finite.
pub fn interpolate_plane_affine(
    from: &DAffine2,
    to: &DAffine2,
    t: f64,
) -> Result<DAffine2, NotFinite> {
    let (from, to) = (PlaneDecomposition::new(from)?, PlaneDecomposition::new(to)?);
    Ok(from.interpolate(&to, t).compose())
}
