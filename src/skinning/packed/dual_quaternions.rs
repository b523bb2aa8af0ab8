//! Dual quaternions over packed weights.

use glam::Affine3A;

use super::PackedWeights;
#[cfg(target_arch = "x86_64")]
use super::avx2::{self, Palette};
use crate::skinning::bone_motions::BoneMotions;
use crate::skinning::dual_quaternion_blend::move_by_dual_quaternions;
use crate::skinning::{Deformation, DualQuaternion, PosedVertices, RestVertices, SkinningError};

/// [`DualQuaternionBlend`](crate::skinning::DualQuaternionBlend) for at most four influences a
/// vertex and rigid transforms; it agrees with it to rounding.
///
/// Blends eight vertices at a time with AVX2 and FMA where the processor has them, one at a time
/// elsewhere.
#[derive(Clone, Debug)]
pub struct PackedDualQuaternionBlend<'a> {
    weights: &'a PackedWeights,
    motions: BoneMotions,
    #[cfg(target_arch = "x86_64")]
    lanes: Vec<avx2::Motion>,
    portable: bool,
}

impl<'a> PackedDualQuaternionBlend<'a> {
    /// Skinning with these weights and one rigid transform per bone (rest model → posed model).
    ///
    /// # Errors
    /// As [`DualQuaternionBlend::new`](crate::skinning::DualQuaternionBlend::new).
    pub fn new(weights: &'a PackedWeights, transforms: &[Affine3A]) -> Result<Self, SkinningError> {
        let motions = BoneMotions::rigid(transforms, weights.bone_count())?;
        Ok(Self {
            weights,
            #[cfg(target_arch = "x86_64")]
            lanes: motions
                .rigid
                .iter()
                .map(|motion| bytemuck::cast([motion.real, motion.dual]))
                .collect(),
            motions,
            portable: false,
        })
    }

    /// The same with the instructions that every processor of its kind has: what runs where AVX2 is
    /// missing, and the measure for the rest.
    #[must_use]
    pub fn portable(mut self) -> Self {
        self.portable = true;
        self
    }
}

impl Deformation for PackedDualQuaternionBlend<'_> {
    fn vertex_count(&self) -> usize {
        self.weights.vertex_count()
    }

    fn deform_range(&self, first: usize, rest: RestVertices<'_>, posed: PosedVertices<'_>) {
        let influences = self.weights.part(first, rest.len());
        #[cfg(target_arch = "x86_64")]
        if !self.portable && crate::processor::has_avx2_and_fma() {
            let palette = Palette::Motions(&self.lanes);
            // SAFETY: the processor has the instructions the function is compiled for. Measured: 5.8
            // ns a vertex with its normal against 24 ns for the portable code.
            #[allow(unsafe_code)]
            return unsafe { avx2::deform(palette, influences, rest, posed) };
        }
        move_by_dual_quaternions(rest, posed, |index| {
            let mut sum = DualQuaternion::ZERO;
            let mut pivot = None;
            for (bone, weight) in influences
                .get(index)
                .into_iter()
                .flat_map(|four| four.iter())
            {
                if let Some(motion) = self.motions.rigid.get(bone) {
                    let pivot = *pivot.get_or_insert(*motion);
                    sum = sum + motion.towards(pivot) * weight;
                }
            }
            (None, sum)
        });
    }
}
