//! Turning and stretching told apart.
//!
//! Shoemake & Duff 1992, "Matrix animation and polar decomposition".

use nalgebra as na;

/// The polar decomposition M = Q S of a 3×3 matrix.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Polar {
    /// Q: the rotation nearest to M (to −M, where M mirrors).
    pub(crate) rotation: na::Matrix3<f64>,
    /// S: symmetric; positive where M does not mirror, negative where it does.
    pub(crate) stretch: na::Matrix3<f64>,
    /// The smallest singular value as a share of the largest, with the sign of M's determinant; 0
    /// for M = 0.
    pub(crate) thickness: f64,
}

impl Polar {
    /// By singular values: with M = U Σ Vᵀ, Q = U Vᵀ and S = V Σ Vᵀ. Singular matrices have one as
    /// well; `None` for a matrix that is not finite.
    pub(crate) fn new(matrix: &na::Matrix3<f64>) -> Option<Self> {
        if !matrix.iter().all(|entry| entry.is_finite()) {
            return None;
        }
        // Scaled, so that no square overflows.
        let scale = matrix.amax();
        let unit = if scale > 0.0 { matrix / scale } else { *matrix };
        let svd = unit.svd(true, true);
        let (mut u, v_t) = (svd.u?, svd.v_t?);
        let mut stretch = v_t.transpose() * na::Matrix3::from_diagonal(&svd.singular_values) * v_t;
        let mut rotation = u * v_t;
        let mirrors = unit.determinant() < 0.0;
        if rotation.determinant() < 0.0 {
            if mirrors {
                // As the paper has it: −1 commutes with everything, so the sign goes to the stretch.
                rotation = -rotation;
                stretch = -stretch;
            } else {
                // A singular matrix has the choice, and takes the stretch that is not negative.
                let flat = svd.singular_values.imin();
                u.column_mut(flat).neg_mut();
                rotation = u * v_t;
            }
        }
        let largest = svd.singular_values.max();
        let ratio = match largest > 0.0 {
            true => svd.singular_values.min() / largest,
            false => 0.0,
        };
        Some(Self {
            rotation,
            stretch: stretch * scale,
            thickness: if mirrors { -ratio } else { ratio },
        })
    }
}
