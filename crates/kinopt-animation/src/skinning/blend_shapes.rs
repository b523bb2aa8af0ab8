//! Blend shapes as whole shapes: a mesh is the weighted mean of its key shapes.

use glam::Vec3;

use super::ROW_SUM_TOLERANCE;
use kinopt_kinematics::Buffer;
use kinopt_kinematics::SizeMismatch;
use kinopt_mesh::mesh::TriangleMesh;

/// Key shapes of one mesh, each with a position for every vertex.
///
/// [`MorphTargets`](super::MorphTargets) store sparse differences from the rest shape and act before skinning. They
/// give the same positions with the weights of all shapes except the rest; the weight of the rest is 1 minus their sum.
///
/// ```
/// use glam::Vec3;
/// use kinopt::skinning::BlendShapes;
///
/// let shapes = BlendShapes::new(vec![
///     ("calm".into(), vec![Vec3::ZERO, Vec3::X]),
///     ("smile".into(), vec![Vec3::Y, Vec3::X]),
/// ])?;
/// let mut face = vec![Vec3::ZERO; 2];
/// shapes.blend(&[0.75, 0.25], &mut face)?;
/// assert_eq!(face, [Vec3::new(0.0, 0.25, 0.0), Vec3::X]);
/// # Ok::<(), kinopt::skinning::BlendShapesError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct BlendShapes {
    names: Vec<String>,
    shapes: Vec<Vec<Vec3>>,
    vertex_count: usize,
}

/// Error of key shapes or their weights.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BlendShapesError {
    /// There are no shapes.
    #[error("there are no shapes")]
    Empty,
    /// Two shapes have the same name.
    #[error("the shape name `{shape}` is used twice")]
    DuplicateName {
        /// Name of the shape.
        shape: String,
    },
    /// A shape has a different number of vertices from the first.
    #[error("shape `{shape}`: {given} vertices, but the first shape has {vertices}")]
    ShapeCount {
        /// Name of the shape.
        shape: String,
        /// Number of vertices of the shape.
        given: usize,
        /// Number of vertices of the first shape.
        vertices: usize,
    },
    /// A position is NaN or infinite.
    #[error("shape `{shape}`, vertex {vertex}: the position is not finite")]
    NonFinite {
        /// Name of the shape.
        shape: String,
        /// Index of the vertex, from 0.
        vertex: usize,
    },
    /// The number of weights differs from the number of shapes.
    #[error("{given} weights for {shapes} shapes: {names}")]
    WeightCount {
        /// Number of weights.
        given: usize,
        /// Number of shapes.
        shapes: usize,
        /// Names of the shapes.
        names: String,
    },
    /// A weight is NaN or infinite.
    #[error("shape `{shape}`: the weight {weight} is not finite")]
    NonFiniteWeight {
        /// Name of the shape.
        shape: String,
        /// The weight.
        weight: f32,
    },
    /// The weights do not sum to 1, so a blend of equal shapes would differ from them.
    #[error("the weights sum to {sum}, not to 1 within {ROW_SUM_TOLERANCE:e}")]
    WeightSum {
        /// Sum of the weights.
        sum: f64,
    },
    /// A buffer has a different length from the shapes.
    #[error(transparent)]
    Size(#[from] SizeMismatch),
}

impl BlendShapes {
    /// Creates key shapes from names and vertex positions in the model's unit.
    ///
    /// # Errors
    /// There are no shapes, a name is used twice, vertex counts differ, or a position is not finite.
    pub fn new(shapes: Vec<(String, Vec<Vec3>)>) -> Result<Self, BlendShapesError> {
        let (names, shapes): (Vec<String>, Vec<Vec<Vec3>>) = shapes.into_iter().unzip();
        let vertex_count = shapes.first().ok_or(BlendShapesError::Empty)?.len();
        let mut seen = std::collections::BTreeSet::new();
        for (name, positions) in names.iter().zip(&shapes) {
            let shape = || name.clone();
            if !seen.insert(name) {
                return Err(BlendShapesError::DuplicateName { shape: shape() });
            }
            if positions.len() != vertex_count {
                return Err(BlendShapesError::ShapeCount {
                    shape: shape(),
                    given: positions.len(),
                    vertices: vertex_count,
                });
            }
            if let Some(vertex) = positions.iter().position(|p| !p.is_finite()) {
                let shape = shape();
                return Err(BlendShapesError::NonFinite { shape, vertex });
            }
        }
        Ok(Self {
            names,
            shapes,
            vertex_count,
        })
    }

    /// Creates key shapes from the positions of meshes with equal triangles.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn of_meshes<'a>(
        meshes: impl IntoIterator<Item = (&'a str, &'a TriangleMesh)>,
    ) -> Result<Self, BlendShapesError> {
        let meshes = meshes.into_iter();
        let shapes = meshes.map(|(name, mesh)| (name.to_owned(), mesh.positions().to_vec()));
        Self::new(shapes.collect())
    }

    /// Names of the shapes, in the order of the weights.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Number of vertices of each shape.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// Blends the shapes: p_i = Σ_j w_j p_ij. The weights must sum to 1 within
    /// [`ROW_SUM_TOLERANCE`](super::ROW_SUM_TOLERANCE). Negative weights exaggerate.
    ///
    /// # Errors
    /// The number of weights differs from the number of shapes, or a slice has a different length from the shapes. Also
    /// a weight that is not finite, or weights that do not sum to 1. Nothing is written then.
    pub fn blend(
        &self,
        weights: &[f32],
        positions: &mut (impl Buffer<Vec3> + ?Sized),
    ) -> Result<(), BlendShapesError> {
        self.check(weights)?;
        let positions = positions.sized(self.vertex_count);
        SizeMismatch::check("positions", positions.len(), self.vertex_count)?;
        positions.fill(Vec3::ZERO);
        let active = self.shapes.iter().zip(weights).filter(|(_, w)| **w != 0.0);
        for (shape, &weight) in active {
            for (out, position) in positions.iter_mut().zip(shape) {
                *out += *position * weight;
            }
        }
        Ok(())
    }

    fn check(&self, weights: &[f32]) -> Result<(), BlendShapesError> {
        if weights.len() != self.names.len() {
            return Err(BlendShapesError::WeightCount {
                given: weights.len(),
                shapes: self.names.len(),
                names: self.names.join(", "),
            });
        }
        let mut named = self.names.iter().zip(weights);
        if let Some((name, &weight)) = named.find(|(_, weight)| !weight.is_finite()) {
            let shape = name.clone();
            return Err(BlendShapesError::NonFiniteWeight { shape, weight });
        }
        let sum: f64 = weights.iter().map(|&weight| f64::from(weight)).sum();
        if (sum - 1.0).abs() > ROW_SUM_TOLERANCE {
            return Err(BlendShapesError::WeightSum { sum });
        }
        Ok(())
    }
}
