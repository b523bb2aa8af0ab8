//! Cages: a coarse closed mesh around a model, whose corners drag the space within along.

use glam::{DVec3, Vec3};

use super::mean_value::mean_value_coordinates;
use crate::mesh::TriangleMesh;
use crate::{Buffer, SizeMismatch};

/// What is wrong with a cage or its use.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CageError {
    /// The triangles do not bound a solid: an edge lacks its neighbour, or there are none.
    #[error("the cage is not closed: every edge must be used once in each direction")]
    NotClosed,
    /// A triangle without area.
    #[error("the cage's triangle {triangle} has no area")]
    FlatTriangle {
        /// Which triangle, from 0.
        triangle: usize,
    },
    /// A point to bind is NaN or infinite.
    #[error("point {point} is not finite")]
    NonFinitePoint {
        /// Which point, from 0.
        point: usize,
    },
    /// The point's weights sum to zero, so there are no coordinates. It happens outside cages only.
    #[error("point {point} has no coordinates in this cage; it is outside")]
    NoCoordinates {
        /// Which point, from 0.
        point: usize,
    },
    /// Not one corner per corner of the cage, or not one place per point.
    #[error(transparent)]
    Size(#[from] SizeMismatch),
}

/// Points bound to a closed triangle cage by mean-value coordinates.
///
/// Ju, Schaefer & Warren 2005, "Mean value coordinates for closed triangular meshes". Each point is
/// Σ_i λ_i c_i with Σ_i λ_i = 1, so affine motions of the whole cage move the points exactly.
/// Coordinates are smooth within the cage and defined outside too; where a cage is concave some are
/// negative. Computed in double precision, kept and applied in single.
///
/// The coordinates of one point take time per triangle of the cage, and memory per corner.
#[derive(Clone, Debug, PartialEq)]
pub struct CageBinding {
    /// A row of coordinates per point, a number per corner.
    coordinates: Vec<f32>,
    corners: usize,
    points: usize,
}

impl CageBinding {
    /// Binds points (in the cage's own unit) to a cage at rest.
    ///
    /// # Errors
    /// The cage is not closed or has a triangle without area, or a point is not finite or has no
    /// coordinates.
    pub fn new(cage: &TriangleMesh, points: &[Vec3]) -> Result<Self, CageError> {
        if !cage.is_closed() {
            return Err(CageError::NotClosed);
        }
        let corners: Vec<DVec3> = cage.positions().iter().map(|c| c.as_dvec3()).collect();
        let size = cage.size();
        for (triangle, &[a, b, c]) in cage.triangles().iter().enumerate() {
            // A mesh's indices are in range.
            let [a, b, c] = [a, b, c].map(|corner| corners[corner as usize]);
            if (b - a).cross(c - a).length() <= 1e-12 * size * size {
                return Err(CageError::FlatTriangle { triangle });
            }
        }
        let mut coordinates = Vec::with_capacity(points.len() * corners.len());
        let mut row = vec![0.0; corners.len()];
        for (point, position) in points.iter().enumerate() {
            if !position.is_finite() {
                return Err(CageError::NonFinitePoint { point });
            }
            let (triangles, at) = (cage.triangles(), position.as_dvec3());
            if !mean_value_coordinates(&corners, triangles, size, at, &mut row) {
                return Err(CageError::NoCoordinates { point });
            }
            coordinates.extend(row.iter().map(|&coordinate| coordinate as f32));
        }
        Ok(Self {
            coordinates,
            corners: corners.len(),
            points: points.len(),
        })
    }

    /// How many points are bound.
    #[must_use]
    pub fn point_count(&self) -> usize {
        self.points
    }

    /// One point's coordinates, a number per corner of the cage; `None` when there is no such point.
    #[must_use]
    pub fn coordinates(&self, point: usize) -> Option<&[f32]> {
        let start = point.checked_mul(self.corners)?;
        let end = start.checked_add(self.corners)?;
        self.coordinates.get(start..end)
    }

    /// Where the points go when the cage's corners are at `cage`: p' = Σ_i λ_i c'_i. Normals are best
    /// computed anew, by [`TriangleMesh::vertex_normals`].
    ///
    /// # Errors
    /// There is not one corner per corner of the cage, or one place per point in a slice.
    pub fn positions(
        &self,
        cage: &[Vec3],
        posed: &mut (impl Buffer<Vec3> + ?Sized),
    ) -> Result<(), CageError> {
        let posed = posed.sized(self.points);
        SizeMismatch::check("cage corners", cage.len(), self.corners)?;
        SizeMismatch::check("posed points", posed.len(), self.points)?;
        let rows = self.coordinates.chunks_exact(self.corners.max(1));
        for (row, posed) in rows.zip(posed) {
            let shares = row.iter().zip(cage);
            *posed = shares.map(|(&share, &corner)| share * corner).sum();
        }
        Ok(())
    }
}
