//! Triangle meshes in single precision.

use std::collections::BTreeSet;

use glam::{DVec3, Vec3};

use crate::SizeMismatch;
use crate::spatial::Vector3;

/// Rounds a double-precision vector to the single precision of meshes. A value beyond the range of
/// `f32` becomes infinite, which [`TriangleMesh::new`] refuses.
#[inline]
#[must_use]
pub fn single_precision(v: Vector3<f64>) -> Vec3 {
    DVec3::new(v.x, v.y, v.z).as_vec3()
}

/// A triangle mesh whose indices are in range and whose numbers are finite.
///
/// Positions are in the model's own unit (metres for robots). Triangles are counter-clockwise seen
/// from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleMesh {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

/// What is wrong with the parts of a [`TriangleMesh`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex}: the position is not finite in single precision")]
    NonFinitePosition {
        /// Which vertex, from 0.
        vertex: usize,
    },
    /// A normal's component is NaN or infinite.
    #[error("vertex {vertex}: the normal is not finite in single precision")]
    NonFiniteNormal {
        /// Which vertex, from 0.
        vertex: usize,
    },
    /// A triangle names a vertex that does not exist.
    #[error(
        "triangle {triangle}: vertex index {index} is out of range; there are {vertices} vertices"
    )]
    IndexOutOfRange {
        /// Which triangle, from 0.
        triangle: usize,
        /// The index it names.
        index: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// There are normals, but not one for each vertex, or new positions of another number.
    #[error(transparent)]
    Size(#[from] SizeMismatch),
}

impl TriangleMesh {
    /// A mesh of its parts; `normals` is empty or holds one vector per vertex.
    ///
    /// # Errors
    /// A [`MeshError`] when a number is not finite, an index is out of range or the counts disagree.
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

    getters! {
        /// The vertices' positions, in the model's own unit.
        pub fn positions(&self) -> &[Vec3] = &self.positions;
        /// The vertices' normals: empty, or one per vertex, as given (not necessarily of unit length).
        pub fn normals(&self) -> &[Vec3] = &self.normals;
        /// The triangles' vertex indices, counted from 0.
        pub fn triangles(&self) -> &[[u32; 3]] = &self.triangles;
    }

    /// The same triangles over other positions and normals, as after skinning.
    ///
    /// # Errors
    /// A [`MeshError`] when the number of positions differs, or as [`new`](Self::new).
    pub fn with_vertices(
        &self,
        positions: Vec<Vec3>,
        normals: Vec<Vec3>,
    ) -> Result<Self, MeshError> {
        SizeMismatch::check("positions", positions.len(), self.positions.len())?;
        Self::new(positions, normals, self.triangles.clone())
    }

    setters! {
        /// This mesh with its normals replaced by [`vertex_normals`](Self::vertex_normals).
        pub fn with_computed_normals(mut self) { self.normals = self.vertex_normals() }
    }

    /// Unit vertex normals: the sum of the adjoining triangles' normals weighted by their areas.
    /// Zero for a vertex that no triangle uses or whose triangles have no area.
    #[must_use]
    pub fn vertex_normals(&self) -> Vec<Vec3> {
        // In double precision, so that no product of finite f32 coordinates can overflow.
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

    /// The lowest and highest corner of the axis-aligned bounding box of all vertices; `None`
    /// without vertices.
    #[must_use]
    pub fn bounding_box(&self) -> Option<[Vec3; 2]> {
        let first = *self.positions.first()?;
        let grow = |[low, high]: [Vec3; 2], p: &Vec3| [low.min(*p), high.max(*p)];
        Some(self.positions.iter().fold([first, first], grow))
    }

    /// The diagonal of the bounding box, in the model's own unit: the length that tolerances scale
    /// with. Zero without vertices.
    #[must_use]
    pub fn size(&self) -> f64 {
        self.bounding_box().map_or(0.0, |[low, high]| {
            (high.as_dvec3() - low.as_dvec3()).length()
        })
    }

    /// Whether the triangles bound a solid consistently: there are triangles, no directed edge
    /// occurs twice, and each one's opposite occurs.
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

    /// The enclosed volume in cubic units of the model, by the divergence theorem: positive where
    /// triangles are counter-clockwise seen from outside. Meaningful for closed meshes only.
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
