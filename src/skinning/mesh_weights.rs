//! Weights in the form that moves a mesh fastest, pose after pose.

use glam::{Affine3A, Vec3};

use super::{
    Deformation, DualQuaternionBlend, LinearBlend, PackedDualQuaternionBlend, PackedLinearBlend,
    PackedWeights, PosedVertices, RestVertices, SkinWeights, SkinningError, SkinningMethod,
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
    /// Weights as they are, also where they could be packed: what packed ones are measured against.
    #[must_use]
    pub fn unpacked(weights: SkinWeights) -> Self {
        Self {
            form: Form::Any(weights),
            pivots: None,
        }
    }

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
        self.blend(method, transforms, |blend| blend.mesh(rest))?
    }

    /// As [`mesh`](Self::mesh), into buffers of the caller's: whichever of positions, normals and
    /// tangents are there.
    ///
    /// # Errors
    /// As [`mesh`](Self::mesh), but that posed vertices are not looked at.
    pub fn deform(
        &self,
        method: SkinningMethod,
        transforms: &[Affine3A],
        rest: RestVertices<'_>,
        posed: PosedVertices<'_>,
    ) -> Result<(), SkinningError> {
        self.blend(method, transforms, |blend| blend.deform(rest, posed))?
    }

    /// What `then` does with the pose.
    fn blend<T>(
        &self,
        method: SkinningMethod,
        transforms: &[Affine3A],
        then: impl FnOnce(&dyn Deformation) -> T,
    ) -> Result<T, SkinningError> {
        use Form::{Any, Packed};
        use SkinningMethod::{DualQuaternion as Dual, LinearBlend as Linear};
        Ok(match (&self.form, method, &self.pivots) {
            (Packed(own), Linear, _) => then(&PackedLinearBlend::new(own, transforms)?),
            (Packed(own), Dual, None) => then(&PackedDualQuaternionBlend::new(own, transforms)?),
            (Packed(own), Dual, Some(pivots)) => then(&PackedDualQuaternionBlend::stretched(
                own, transforms, pivots,
            )?),
            (Any(own), Linear, _) => then(&LinearBlend::new(own, transforms)?),
            (Any(own), Dual, None) => then(&DualQuaternionBlend::new(own, transforms)?),
            (Any(own), Dual, Some(pivots)) => {
                then(&DualQuaternionBlend::stretched(own, transforms, pivots)?)
            }
        })
    }
}
