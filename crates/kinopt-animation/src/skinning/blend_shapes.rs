//! Blend shapes as whole shapes: a mesh is the weighted mean of its key shapes.

use glam::Vec3;

use super::ROW_SUM_TOLERANCE;
use crate::skinning::SkinningError;
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
/// # Ok::<(), kinopt::skinning::SkinningError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct BlendShapes {
    names: Vec<String>,
    shapes: Vec<Vec<Vec3>>,
    vertex_count: usize,
}

impl BlendShapes {
    /// Creates key shapes from names and vertex positions in the model's unit.
    ///
    /// # Errors
    /// There are no shapes, a name is used twice, vertex counts differ, or a position is not finite.
    pub fn new(shapes: Vec<(String, Vec<Vec3>)>) -> Result<Self, SkinningError> {
        let (names, shapes): (Vec<String>, Vec<Vec<Vec3>>) = shapes.into_iter().unzip();
        let vertex_count = shapes.first().ok_or(SkinningError::NoShapes)?.len();
        let mut seen = std::collections::BTreeSet::new();
        for (name, positions) in names.iter().zip(&shapes) {
            let shape = || name.clone();
            if !seen.insert(name) {
                return Err(SkinningError::DuplicateShape { shape: shape() });
            }
            if positions.len() != vertex_count {
                return Err(SkinningError::ShapeCount {
                    shape: shape(),
                    given: positions.len(),
                    vertices: vertex_count,
                });
            }
            if let Some(vertex) = positions.iter().position(|p| !p.is_finite()) {
                let shape = shape();
                return Err(SkinningError::NonFiniteShape { shape, vertex });
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
    ) -> Result<Self, SkinningError> {
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
    ) -> Result<(), SkinningError> {
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

    fn check(&self, weights: &[f32]) -> Result<(), SkinningError> {
        if weights.len() != self.names.len() {
            return Err(SkinningError::ShapeWeightCount {
                given: weights.len(),
                shapes: self.names.len(),
                names: self.names.join(", "),
            });
        }
        let mut named = self.names.iter().zip(weights);
        if let Some((name, &weight)) = named.find(|(_, weight)| !weight.is_finite()) {
            let shape = name.clone();
            return Err(SkinningError::NonFiniteShapeWeight { shape, weight });
        }
        let sum: f64 = weights.iter().map(|&weight| f64::from(weight)).sum();
        if (sum - 1.0).abs() > ROW_SUM_TOLERANCE {
            return Err(SkinningError::ShapeWeightSum { sum });
        }
        Ok(())
    }
}
