//! Weights in the form that moves a mesh fastest, pose after pose.

use glam::Affine3A;

use super::{
    Deformation, PackedDualQuaternionBlend, PackedLinearBlend, PackedWeights, SkinWeights,
    SkinningError, SkinningMethod,
};
use crate::mesh::TriangleMesh;

/// Skin weights made ready once for many poses: packed where no vertex follows more than four
/// bones, as they are otherwise. Both give the same vertices to rounding.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshWeights(Form);

#[derive(Clone, Debug, PartialEq)]
enum Form {
    Packed(PackedWeights),
    Any(SkinWeights),
}

impl From<SkinWeights> for MeshWeights {
    fn from(weights: SkinWeights) -> Self {
        Self(match PackedWeights::new(&weights) {
            Ok(packed) => Form::Packed(packed),
            Err(_) => Form::Any(weights),
        })
    }
}

impl MeshWeights {
    /// Whether the four packed influences of the fast path are enough.
    #[must_use]
    pub fn is_packed(&self) -> bool {
        matches!(self.0, Form::Packed(_))
    }

    /// The posed mesh: positions, and normals where the mesh has them. Transforms are one per bone,
    /// rest model → posed model.
    ///
    /// # Errors
    /// Counts disagree, a number is not finite, or a transform is not rigid where it must be.
    pub fn mesh(
        &self,
        method: SkinningMethod,
        rest: &TriangleMesh,
        transforms: &[Affine3A],
    ) -> Result<TriangleMesh, SkinningError> {
        match (&self.0, method) {
            (Form::Packed(weights), SkinningMethod::LinearBlend) => {
                PackedLinearBlend::new(weights, transforms)?.mesh(rest)
            }
            (Form::Packed(weights), SkinningMethod::DualQuaternion) => {
                PackedDualQuaternionBlend::new(weights, transforms)?.mesh(rest)
            }
            (Form::Any(weights), method) => method.mesh(rest, weights, transforms),
        }
    }
}
