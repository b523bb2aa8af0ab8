//! Cages: coarse closed meshes around a model whose corners deform the space inside.

use glam::{DVec3, Vec3};

use super::mean_value::mean_value_coordinates;
use crate::skinning::SkinningError;
use kinopt_kinematics::Buffer;
use kinopt_kinematics::SizeMismatch;
use kinopt_mesh::mesh::TriangleMesh;

/// Points bound to a closed triangle cage by mean-value coordinates.
///
/// Source: Ju, Schaefer & Warren 2005, "Mean value coordinates for closed triangular meshes". Each point is Σ_i λ_i c_i
/// with Σ_i λ_i = 1, so affine motions of the whole cage move the points exactly.
///
/// Coordinates are smooth inside the cage and defined outside as well. Concave cages give some negative ones. They are
/// computed in double precision, and stored and applied in single precision. Time per point is linear in the triangles
/// of the cage, memory in its corners.
#[derive(Clone, Debug, PartialEq)]
pub struct CageBinding {
    /// One row per point, one number per corner.
    coordinates: Vec<f32>,
    corners: usize,
    points: usize,
}

impl CageBinding {
    /// Binds points to a cage at rest, both in the cage's frame and unit.
    ///
    /// # Errors
    /// The cage is not closed or has a triangle without area. Also a point that is not finite or has no coordinates.
    pub fn new(cage: &TriangleMesh, points: &[Vec3]) -> Result<Self, SkinningError> {
        if !cage.is_closed() {
            return Err(SkinningError::NotClosed);
        }
        let corners: Vec<DVec3> = cage.positions().iter().map(|c| c.as_dvec3()).collect();
        let size = cage.size();
        for (triangle, &[a, b, c]) in cage.triangles().iter().enumerate() {
            // Indices of a mesh are in range.
            let [a, b, c] = [a, b, c].map(|corner| corners[corner as usize]);
            if (b - a).cross(c - a).length() <= 1e-12 * size * size {
                return Err(SkinningError::FlatTriangle { triangle });
            }
        }
        let mut coordinates = Vec::with_capacity(points.len() * corners.len());
        let mut row = vec![0.0; corners.len()];
        for (point, position) in points.iter().enumerate() {
            if !position.is_finite() {
                return Err(SkinningError::NonFinitePoint { point });
            }
            let (triangles, at) = (cage.triangles(), position.as_dvec3());
            if !mean_value_coordinates(&corners, triangles, size, at, &mut row) {
                return Err(SkinningError::NoCoordinates { point });
            }
            coordinates.extend(row.iter().map(|&coordinate| coordinate as f32));
        }
        Ok(Self {
            coordinates,
            corners: corners.len(),
            points: points.len(),
        })
    }

    /// Number of bound points.
    #[must_use]
    pub fn point_count(&self) -> usize {
        self.points
    }

    /// Coordinates of one point, one number per corner of the cage; `None` for an unknown point.
    #[must_use]
    pub fn coordinates(&self, point: usize) -> Option<&[f32]> {
        let start = point.checked_mul(self.corners)?;
        let end = start.checked_add(self.corners)?;
        self.coordinates.get(start..end)
    }

    /// Writes the positions of the points for posed corners `cage`: p' = Σ_i λ_i c'_i. [`TriangleMesh::vertex_normals`]
    /// computes normals for the new positions.
    ///
    /// # Errors
    /// The number of corners differs from that of the cage, or the length of a slice from the number of points.
    pub fn positions(
        &self,
        cage: &[Vec3],
        posed: &mut (impl Buffer<Vec3> + ?Sized),
    ) -> Result<(), SkinningError> {
        let posed = posed.sized(self.points);
        SizeMismatch::check("cage corners", cage.len(), self.corners)?;
        SizeMismatch::check("posed points", posed.len(), self.points)?;
        let rows = self.coordinates.chunks_exact(self.corners.max(1));
        for (row, posed) in rows.zip(posed) {
            let pairs = row.iter().zip(cage);
            *posed = pairs
                .map(|(&coordinate, &corner)| coordinate * corner)
                .sum();
        }
        Ok(())
    }
}
