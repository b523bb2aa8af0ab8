//! Weights in the form that moves a mesh fastest, pose after pose.

use glam::{Affine3A, Vec3};

use super::{
    Deformation, DualQuaternionBlend, PackedDualQuaternionBlend, PackedLinearBlend, PackedWeights,
    SkinWeights, SkinningError, SkinningMethod,
};
use crate::mesh::TriangleMesh;

/// Skin weights made ready once for many poses: packed where no vertex follows more than four
/// bones, as they are otherwise. Both give the same vertices to rounding. Nothing is pruned unasked:
/// weights of more influences become fast by [`SkinWeights::pruned`] first, which says what is lost.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshWeights {
    form: Form,
    pivots: Option<Vec<Vec3>>,
}

#[derive(Clone, Debug, PartialEq)]
enum Form {
    Packed(PackedWeights),
    Any(SkinWeights),
}

impl From<SkinWeights> for MeshWeights {
    fn from(weights: SkinWeights) -> Self {
        let form = match PackedWeights::new(&weights) {
            Ok(packed) => Form::Packed(packed),
            Err(_) => Form::Any(weights),
        };
        Self { form, pivots: None }
    }
}

impl MeshWeights {
    /// Whether the four packed influences of the fast path are enough.
    #[must_use]
    pub fn is_packed(&self) -> bool {
        matches!(self.form, Form::Packed(_))
    }

    /// Lets dual quaternions take transforms that scale: each bone stretches about its pivot, the
    /// bone's tail at rest in the model's unit, as
    /// [`DualQuaternionBlend::stretched`] has it.
    #[must_use]
    pub fn with_pivots(self, pivots: Vec<Vec3>) -> Self {
        let pivots = Some(pivots);
        Self { pivots, ..self }
    }

    /// The posed mesh: positions, and normals where the mesh has them. Transforms are one per bone,
    /// rest model → posed model.
    ///
    /// # Errors
    /// Counts disagree, a number is not finite, or a transform is not rigid where it must be: with
    /// dual quaternions and without pivots.
    pub fn mesh(
        &self,
        method: SkinningMethod,
        rest: &TriangleMesh,
        transforms: &[Affine3A],
    ) -> Result<TriangleMesh, SkinningError> {
        use SkinningMethod::{DualQuaternion, LinearBlend as Linear};
        match (&self.form, method, &self.pivots) {
            (Form::Packed(weights), Linear, _) => {
                PackedLinearBlend::new(weights, transforms)?.mesh(rest)
            }
            (Form::Packed(weights), DualQuaternion, None) => {
                PackedDualQuaternionBlend::new(weights, transforms)?.mesh(rest)
            }
            (Form::Packed(weights), DualQuaternion, Some(pivots)) => {
                PackedDualQuaternionBlend::stretched(weights, transforms, pivots)?.mesh(rest)
            }
            (Form::Any(weights), DualQuaternion, Some(pivots)) => {
                DualQuaternionBlend::stretched(weights, transforms, pivots)?.mesh(rest)
            }
            (Form::Any(weights), method, _) => method.mesh(rest, weights, transforms),
        }
    }
}
