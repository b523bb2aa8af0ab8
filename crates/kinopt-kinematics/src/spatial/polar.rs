//! Polar decomposition of a 3×3 matrix into rotation and stretch.
//!
//! Shoemake & Duff 1992, "Matrix animation and polar decomposition".

use glam::{DMat3, DQuat, DVec3};
use nalgebra as na;

/// The polar decomposition M = Q S of a 3×3 matrix.
#[derive(Clone, Copy, Debug)]
#[doc(hidden)]
pub struct Polar {
    /// Q: the rotation nearest to M, or to −M if det M < 0.
    #[doc(hidden)]
    pub rotation: na::Matrix3<f64>,
    /// S: symmetric; positive semidefinite if det M ≥ 0, negative otherwise.
    #[doc(hidden)]
    pub stretch: na::Matrix3<f64>,
    /// Smallest singular value divided by the largest, with the sign of det M; 0 for M = 0.
    #[doc(hidden)]
    pub thickness: f64,
    /// Middle singular value divided by the largest; 0 for M = 0.
    #[doc(hidden)]
    pub middle: f64,
}

impl Polar {
    /// Decomposes by singular values: with M = U Σ Vᵀ, Q = U Vᵀ and S = V Σ Vᵀ.
    ///
    /// Singular matrices have a decomposition too. Returns `None` for a matrix with an entry that is not finite.
    #[doc(hidden)]
    pub fn new(matrix: &na::Matrix3<f64>) -> Option<Self> {
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
                // As in the paper: −1 commutes with every matrix, so the stretch takes the sign.
                rotation = -rotation;
                stretch = -stretch;
            } else {
                // For a singular matrix the sign is free: choose the positive semidefinite stretch.
                let smallest = svd.singular_values.imin();
                u.column_mut(smallest).neg_mut();
                rotation = u * v_t;
            }
        }
        let largest = svd.singular_values.max();
        let ratio = match largest > 0.0 {
            true => svd.singular_values.min() / largest,
            false => 0.0,
        };
        // Singular values are sorted from the largest.
        let middle = match largest > 0.0 {
            true => svd.singular_values[1] / largest,
            false => 0.0,
        };
        Some(Self {
            rotation,
            stretch: stretch * scale,
            thickness: if mirrors { -ratio } else { ratio },
            middle,
        })
    }

    /// Decomposes a matrix that is singular up to rounding, whatever the sign of its determinant. The rotation is
    /// nearest to M. If many are, because the rank is 1, it is the smallest of them; for M = 0 it is the identity.
    ///
    /// Singular values up to `tolerance` times the largest count as 0. Returns `None` for a matrix with an entry that is
    /// not finite.
    #[doc(hidden)]
    pub fn of_singular(matrix: &na::Matrix3<f64>, tolerance: f64) -> Option<Self> {
        let mut polar = Self::new(matrix)?;
        let scale = matrix.amax();
        if scale == 0.0 {
            polar.rotation = na::Matrix3::identity();
            return Some(polar);
        }
        let svd = (matrix / scale).svd(true, true);
        let (mut u, v_t) = (svd.u?, svd.v_t?);
        polar.rotation = if polar.middle <= tolerance {
            let [from, to] = [v_t.row(0).transpose(), u.column(0).into_owned()]
                .map(|axis: na::Vector3<f64>| DVec3::new(axis.x, axis.y, axis.z).normalize());
            let columns = DMat3::from_quat(DQuat::from_rotation_arc(from, to));
            na::Matrix3::from_column_slice(&columns.to_cols_array())
        } else {
            if (u * v_t).determinant() < 0.0 {
                u.column_mut(2).neg_mut();
            }
            u * v_t
        };
        polar.stretch = polar.rotation.transpose() * matrix;
        Some(polar)
    }
}
