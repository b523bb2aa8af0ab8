//! Skin weights prepared for many poses.

use glam::{Affine3A, Vec3};

use super::{
    Deformation, DualQuaternionBlend, LinearBlend, PackedDualQuaternionBlend, PackedLinearBlend,
    PackedWeights, PosedVertices, RestVertices, SkinWeights, SkinningError, SkinningMethod,
};
use kinopt_mesh::mesh::TriangleMesh;

/// Skin weights prepared once for many poses. They are packed if no vertex has more than four influences. Both forms
/// give the same vertices up to rounding.
///
/// Weights are never pruned implicitly. Call [`SkinWeights::pruned`] first for speed; it returns the loss.
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
    /// Keeps weights unpacked, for comparisons with packed ones.
    #[must_use]
    pub fn unpacked(weights: SkinWeights) -> Self {
        Self {
            form: Form::Any(weights),
            pivots: None,
        }
    }

    /// Reports whether the weights are packed, with at most four influences per vertex.
    #[must_use]
    pub fn is_packed(&self) -> bool {
        matches!(self.form, Form::Packed(_))
    }

    /// Sets pivots, so that dual quaternions accept transforms that scale: see [`DualQuaternionBlend::stretched`]. Each
    /// bone stretches about its pivot, the tail of the bone at rest in the model's unit.
    #[must_use]
    pub fn with_pivots(self, pivots: Vec<Vec3>) -> Self {
        let pivots = Some(pivots);
        Self { pivots, ..self }
    }

    /// The posed mesh: positions, and normals if the mesh has them. There is one transform per bone, rest model → posed
    /// model.
    ///
    /// # Errors
    /// Counts differ, or a number is not finite. Also a transform that is not rigid, for dual quaternions without
    /// pivots.
    pub fn mesh(
        &self,
        method: SkinningMethod,
        rest: &TriangleMesh,
        transforms: &[Affine3A],
    ) -> Result<TriangleMesh, SkinningError> {
        self.blend(method, transforms, |blend| blend.mesh(rest))?
    }

    /// As [`mesh`](Self::mesh), into the caller's buffers: positions, normals and tangents, as far as the buffers are
    /// not empty.
    ///
    /// # Errors
    /// As [`mesh`](Self::mesh), except that posed vertices may be non-finite.
    pub fn deform(
        &self,
        method: SkinningMethod,
        transforms: &[Affine3A],
        rest: RestVertices<'_>,
        posed: PosedVertices<'_>,
    ) -> Result<(), SkinningError> {
        self.blend(method, transforms, |blend| blend.deform(rest, posed))?
    }

    /// Calls `then` with the pose.
    fn blend<T>(
        &self,
        method: SkinningMethod,
        transforms: &[Affine3A],
        then: impl FnOnce(&dyn Deformation) -> T,
    ) -> Result<T, SkinningError> {
        use Form::{Any, Packed};
        use SkinningMethod::{DualQuaternion as Dual, LinearBlend as Linear};
        Ok(match (&self.form, method, &self.pivots) {
            (Packed(weights), Linear, _) => then(&PackedLinearBlend::new(weights, transforms)?),
            (Packed(weights), Dual, None) => {
                then(&PackedDualQuaternionBlend::new(weights, transforms)?)
            }
            (Packed(weights), Dual, Some(pivots)) => then(&PackedDualQuaternionBlend::stretched(
                weights, transforms, pivots,
            )?),
            (Any(weights), Linear, _) => then(&LinearBlend::new(weights, transforms)?),
            (Any(weights), Dual, None) => then(&DualQuaternionBlend::new(weights, transforms)?),
            (Any(weights), Dual, Some(pivots)) => then(&DualQuaternionBlend::stretched(
                weights, transforms, pivots,
            )?),
        })
    }
}
