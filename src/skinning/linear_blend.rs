//! Linear blend skinning: each vertex follows the weighted mean of its bones' transforms.

use glam::{Affine3A, Mat3A, Vec3, Vec3A};

use super::{Influence, SkinWeights};
use crate::mesh::{MeshError, TriangleMesh, single_precision};
use crate::spatial::Placement;

/// Why a mesh cannot be skinned.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SkinningError {
    /// The transforms are for another number of bones than the weights.
    #[error("{given} bone transforms for weights of {bones} bones")]
    TransformCount {
        /// How many were given.
        given: usize,
        /// How many bones the weights know.
        bones: usize,
    },
    /// A buffer of vertices is of another length than the weights.
    #[error("{given} {what} for weights of {vertices} vertices")]
    VertexCount {
        /// "rest positions", "posed normals", …
        what: &'static str,
        /// How many there are.
        given: usize,
        /// How many vertices the weights know.
        vertices: usize,
    },
    /// The posed mesh holds a number that is not finite in single precision.
    #[error("the posed mesh: {0}")]
    Mesh(#[from] MeshError),
}

/// A bone's transform T = W T̂⁻¹ (rest model → posed model) in the precision of meshes.
#[must_use]
pub fn single_precision_transform(posed_from_rest: &Placement<f64>) -> Affine3A {
    let Placement {
        rotation,
        translation,
    } = *posed_from_rest;
    let column = |v| Vec3A::from(single_precision(v));
    Affine3A {
        matrix3: Mat3A::from_cols(column(rotation.x), column(rotation.y), column(rotation.z)),
        translation: column(translation),
    }
}

/// One pose, ready to move any buffers of vertices: v' = Σ_j w_j T_j v̂.
///
/// Works in single precision, with any number of influences; a vertex's result is off by a few
/// units in the last place of the largest coordinate involved, in the model's own frame. Nothing
/// allocates except [`mesh`](Self::mesh).
#[derive(Clone, Copy, Debug)]
pub struct LinearBlend<'a> {
    weights: &'a SkinWeights,
    transforms: &'a [Affine3A],
}

impl<'a> LinearBlend<'a> {
    /// Skinning with these weights and one transform per bone (rest model → posed model), as
    /// [`single_precision_transform`] makes them of
    /// [`skinning_transforms`](crate::skeleton::BonePlacements::skinning_transforms).
    ///
    /// # Errors
    /// There is not one transform per bone of the weights.
    pub fn new(
        weights: &'a SkinWeights,
        transforms: &'a [Affine3A],
    ) -> Result<Self, SkinningError> {
        if transforms.len() != weights.bone_count() {
            return Err(SkinningError::TransformCount {
                given: transforms.len(),
                bones: weights.bone_count(),
            });
        }
        Ok(Self {
            weights,
            transforms,
        })
    }

    /// Moves positions, in the model's own unit. A vertex without influences goes to the origin, as
    /// the empty sum says.
    ///
    /// # Errors
    /// `rest` or `posed` has another length than the weights have vertices.
    pub fn positions(&self, rest: &[Vec3], posed: &mut [Vec3]) -> Result<(), SkinningError> {
        self.check("rest positions", rest.len())?;
        self.check("posed positions", posed.len())?;
        for ((posed, &rest), influences) in posed.iter_mut().zip(rest).zip(self.weights.iter()) {
            let blended = self.blended(influences);
            *posed = blended.transform_point3(rest);
        }
        Ok(())
    }

    /// Turns normals by the blended matrix's inverse transpose and makes them of unit length. A
    /// normal that is zero stays zero, and one that the blend leaves without direction becomes zero.
    ///
    /// # Errors
    /// `rest` or `posed` has another length than the weights have vertices.
    pub fn normals(&self, rest: &[Vec3], posed: &mut [Vec3]) -> Result<(), SkinningError> {
        self.check("rest normals", rest.len())?;
        self.check("posed normals", posed.len())?;
        for ((posed, &rest), influences) in posed.iter_mut().zip(rest).zip(self.weights.iter()) {
            *posed = turned_normal(&self.blended(influences).matrix3, rest);
        }
        Ok(())
    }

    /// The posed mesh: positions, and normals where the rest mesh has them.
    ///
    /// # Errors
    /// The mesh has another number of vertices than the weights, or the result is not finite.
    pub fn mesh(&self, rest: &TriangleMesh) -> Result<TriangleMesh, SkinningError> {
        let mut positions = vec![Vec3::ZERO; rest.positions().len()];
        let mut normals = vec![Vec3::ZERO; rest.normals().len()];
        self.positions(rest.positions(), &mut positions)?;
        if !normals.is_empty() {
            self.normals(rest.normals(), &mut normals)?;
        }
        Ok(rest.with_vertices(positions, normals)?)
    }

    /// Σ_j w_j T_j.
    fn blended(&self, influences: &[Influence]) -> Affine3A {
        let mut sum = Affine3A::ZERO;
        for influence in influences {
            // The weights' own check keeps bones in range.
            if let Some(transform) = self.transforms.get(influence.bone as usize) {
                let weight = influence.weight as f32;
                sum.matrix3 += transform.matrix3 * weight;
                sum.translation += transform.translation * weight;
            }
        }
        sum
    }

    fn check(&self, what: &'static str, given: usize) -> Result<(), SkinningError> {
        let vertices = self.weights.vertex_count();
        if given == vertices {
            return Ok(());
        }
        Err(SkinningError::VertexCount {
            what,
            given,
            vertices,
        })
    }
}

/// M⁻ᵀ n / ‖M⁻ᵀ n‖. The cofactors of M are its inverse transpose times its determinant, so only the
/// determinant's sign is needed and a singular M is no special case.
fn turned_normal(matrix: &Mat3A, normal: Vec3) -> Vec3 {
    let largest = normal.abs().max_element();
    if largest == 0.0 {
        return Vec3::ZERO;
    }
    // Scaled, because the square of a short normal would underflow.
    let n = Vec3A::from(normal / largest);
    let (x, y, z) = (matrix.x_axis, matrix.y_axis, matrix.z_axis);
    let cofactors = Mat3A::from_cols(y.cross(z), z.cross(x), x.cross(y));
    let turned = Vec3::from((cofactors * n).normalize_or_zero());
    if x.dot(cofactors.x_axis) < 0.0 {
        -turned
    } else {
        turned
    }
}
