//! Triangle meshes in single precision.

use std::collections::BTreeSet;

use glam::{DVec3, Vec3};

use crate::SizeMismatch;
use crate::spatial::Vector3;

/// Rounds a double-precision vector to the single precision of meshes.
///
/// A value beyond the range of `f32` becomes infinite, which [`TriangleMesh::new`] rejects.
#[inline]
#[must_use]
pub fn single_precision(v: Vector3<f64>) -> Vec3 {
    DVec3::new(v.x, v.y, v.z).as_vec3()
}

/// A triangle mesh with valid indices and finite numbers.
///
/// Positions are in the model's unit (metres for robots). Triangles are counter-clockwise, seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleMesh {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

/// Errors of the parts of a [`TriangleMesh`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// A coordinate of a position is NaN or infinite.
    #[error("vertex {vertex}: the position is not finite in single precision")]
    NonFinitePosition {
        /// Index of the vertex, from 0.
        vertex: usize,
    },
    /// A component of a normal is NaN or infinite.
    #[error("vertex {vertex}: the normal is not finite in single precision")]
    NonFiniteNormal {
        /// Index of the vertex, from 0.
        vertex: usize,
    },
    /// A triangle with the index of a vertex that does not exist.
    #[error(
        "triangle {triangle}: vertex index {index} is out of range; there are {vertices} vertices"
    )]
    IndexOutOfRange {
        /// Index of the triangle, from 0.
        triangle: usize,
        /// The invalid vertex index.
        index: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// A number of normals, or of new positions, that differs from the number of vertices.
    #[error(transparent)]
    Size(#[from] SizeMismatch),
}

impl TriangleMesh {
    /// A mesh from its parts; `normals` is empty or has one vector per vertex.
    ///
    /// # Errors
    /// Returns a [`MeshError`] if a number is not finite, an index is out of range or the numbers of elements differ.
    pub fn new(
        positions: Vec<Vec3>,
        normals: Vec<Vec3>,
        triangles: Vec<[u32; 3]>,
    ) -> Result<Self, MeshError> {
        if let Some(vertex) = positions.iter().position(|p| !p.is_finite()) {
            return Err(MeshError::NonFinitePosition { vertex });
        }
        if let Some(vertex) = normals.iter().position(|n| !n.is_finite()) {
            return Err(MeshError::NonFiniteNormal { vertex });
        }
        let vertices = positions.len();
        if !normals.is_empty() {
            SizeMismatch::check("normals", normals.len(), vertices)?;
        }
        for (triangle, corners) in triangles.iter().enumerate() {
            for &index in corners {
                if index as usize >= vertices {
                    return Err(MeshError::IndexOutOfRange {
                        triangle,
                        index,
                        vertices,
                    });
                }
            }
        }
        Ok(Self {
            positions,
            normals,
            triangles,
        })
    }

    /// Positions of the vertices, in the model's unit.
    #[must_use]
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Normals of the vertices: empty, or one per vertex, as given (not necessarily of unit length).
    #[must_use]
    pub fn normals(&self) -> &[Vec3] {
        &self.normals
    }

    /// Vertex indices of the triangles, from 0.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The same triangles with other positions and normals, for example after skinning.
    ///
    /// # Errors
    /// Returns a [`MeshError`] if the number of positions differs, and the errors of [`new`](Self::new).
    pub fn with_vertices(
        &self,
        positions: Vec<Vec3>,
        normals: Vec<Vec3>,
    ) -> Result<Self, MeshError> {
        SizeMismatch::check("positions", positions.len(), self.positions.len())?;
        Self::new(positions, normals, self.triangles.clone())
    }

    /// Replaces the normals by [`vertex_normals`](Self::vertex_normals).
    #[must_use]
    pub fn with_computed_normals(mut self) -> Self {
        self.normals = self.vertex_normals();
        self
    }

    /// Unit vertex normals: the area-weighted sums of the adjacent triangles' normals.
    ///
    /// Zero for a vertex without triangles, or whose triangles have no area.
    #[must_use]
    pub fn vertex_normals(&self) -> Vec<Vec3> {
        // In double precision, so that no product of finite f32 coordinates overflows.
        let mut sums = vec![DVec3::ZERO; self.positions.len()];
        for &triangle in &self.triangles {
            let [a, b, c] = self.corners(triangle);
            let twice_area = (b - a).cross(c - a);
            for index in triangle {
                if let Some(sum) = sums.get_mut(index as usize) {
                    *sum += twice_area;
                }
            }
        }
        sums.into_iter()
            .map(|sum| sum.normalize_or_zero().as_vec3())
            .collect()
    }

    /// Lowest and highest corner of the axis-aligned bounding box of all vertices; `None` without vertices.
    #[must_use]
    pub fn bounding_box(&self) -> Option<[Vec3; 2]> {
        let first = *self.positions.first()?;
        let grow = |[low, high]: [Vec3; 2], p: &Vec3| [low.min(*p), high.max(*p)];
        Some(self.positions.iter().fold([first, first], grow))
    }

    /// Diagonal of the bounding box, in the model's unit, with which tolerances scale. Zero without vertices.
    #[must_use]
    pub fn size(&self) -> f64 {
        self.bounding_box().map_or(0.0, |[low, high]| {
            (high.as_dvec3() - low.as_dvec3()).length()
        })
    }

    /// True if the triangles enclose a solid with consistent orientation.
    ///
    /// There must be triangles, no directed edge may occur twice, and the opposite of each must occur.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        let mut edges = BTreeSet::new();
        for &[a, b, c] in &self.triangles {
            for edge in [(a, b), (b, c), (c, a)] {
                if edge.0 == edge.1 || !edges.insert(edge) {
                    return false;
                }
            }
        }
        !edges.is_empty() && edges.iter().all(|&(a, b)| edges.contains(&(b, a)))
    }

    /// Enclosed volume in cubic units of the model, by the divergence theorem.
    ///
    /// Positive if triangles are counter-clockwise, seen from outside. Meaningful for closed meshes only.
    #[must_use]
    pub fn signed_volume(&self) -> f64 {
        // Relative to a vertex, because far from the origin the large terms would cancel.
        let origin = self.positions.first().map_or(DVec3::ZERO, |p| p.as_dvec3());
        let sum: f64 = self
            .triangles
            .iter()
            .map(|&triangle| {
                let [a, b, c] = self.corners(triangle).map(|p| p - origin);
                a.dot(b.cross(c))
            })
            .sum();
        sum / 6.0
    }

    fn corners(&self, triangle: [u32; 3]) -> [DVec3; 3] {
        triangle.map(|index| {
            self.positions
                .get(index as usize)
                .map_or(DVec3::ZERO, |p| p.as_dvec3())
        })
    }
}
