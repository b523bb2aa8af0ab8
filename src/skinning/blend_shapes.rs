//! Blend shapes given as whole poses: a mesh is the weighted mean of its key shapes.

use glam::Vec3;

use super::ROW_SUM_TOLERANCE;
use crate::mesh::TriangleMesh;
use crate::{Buffer, SizeMismatch};

/// Key shapes of one mesh, each with a place for every vertex.
///
/// Where one shape is the rest and the others are differences from it, which are sparse and come
/// before skinning, [`MorphTargets`](super::MorphTargets) give the same positions: theirs are the
/// weights of all shapes but the rest, whose share is what is missing to 1.
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

/// What is wrong with key shapes or their weights.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BlendShapesError {
    /// There are no shapes.
    #[error("there are no shapes")]
    Empty,
    /// Two shapes of one name.
    #[error("the shape name `{shape}` is used twice")]
    DuplicateName {
        /// The name.
        shape: String,
    },
    /// A shape has another number of vertices than the first.
    #[error("shape `{shape}`: {given} vertices, but the first shape has {vertices}")]
    ShapeCount {
        /// The shape's name.
        shape: String,
        /// How many it has.
        given: usize,
        /// How many the first has.
        vertices: usize,
    },
    /// A position is NaN or infinite.
    #[error("shape `{shape}`, vertex {vertex}: the position is not finite")]
    NonFinite {
        /// The shape's name.
        shape: String,
        /// Which vertex.
        vertex: usize,
    },
    /// There is not one weight per shape.
    #[error("{given} weights for {shapes} shapes: {names}")]
    WeightCount {
        /// How many weights.
        given: usize,
        /// How many shapes.
        shapes: usize,
        /// The shapes' names.
        names: String,
    },
    /// A weight is NaN or infinite.
    #[error("shape `{shape}`: the weight {weight} is not finite")]
    NonFiniteWeight {
        /// The shape's name.
        shape: String,
        /// The weight.
        weight: f32,
    },
    /// The weights do not sum to 1, so that a shape common to all would not be kept.
    #[error("the weights sum to {sum}, not to 1 within {ROW_SUM_TOLERANCE:e}")]
    WeightSum {
        /// What they sum to.
        sum: f64,
    },
    /// A buffer is not as long as the shapes.
    #[error(transparent)]
    Size(#[from] SizeMismatch),
}

impl BlendShapes {
    /// Key shapes by name, each with the position of every vertex in the model's own unit.
    ///
    /// # Errors
    /// There is none, a name is used twice, counts of vertices differ, or a position is not finite.
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

    /// The positions of meshes that share their triangles.
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

    getters! {
        /// The shapes' names, in the order of the weights.
        pub fn names(&self) -> &[String] = &self.names;
        /// How many vertices each shape has.
        pub fn vertex_count(&self) -> usize = self.vertex_count;
    }

    /// p_i = Σ_j w_j p_ij. The weights must sum to 1 within
    /// [`ROW_SUM_TOLERANCE`](super::ROW_SUM_TOLERANCE); negative ones exaggerate.
    ///
    /// # Errors
    /// There is not one weight per shape, one is not finite, they do not sum to 1, or there is not
    /// room for every vertex in a slice. Nothing is written then.
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
