//! Dual quaternion skinning with packed weights.

use glam::{Affine3A, Vec3};

use super::PackedWeights;
#[cfg(target_arch = "x86_64")]
use super::avx2::{self, Palette};
use crate::skinning::bone_motions::BoneMotions;
use crate::skinning::dual_quaternion_blend::move_by_dual_quaternions;
use crate::skinning::{Deformation, DualQuaternion, PosedVertices, RestVertices, SkinningError};

/// [`DualQuaternionBlend`](crate::skinning::DualQuaternionBlend) for at most four influences per vertex. The results
/// agree up to rounding.
///
/// It blends eight vertices at a time on processors with AVX2 and FMA, and one at a time on others.
#[derive(Clone, Debug)]
pub struct PackedDualQuaternionBlend<'a> {
    weights: &'a PackedWeights,
    motions: BoneMotions,
    #[cfg(target_arch = "x86_64")]
    lanes: Vec<avx2::PackedDualQuaternion>,
    /// Empty if no bone stretches.
    #[cfg(target_arch = "x86_64")]
    stretches: Vec<avx2::Columns>,
    portable: bool,
}

impl<'a> PackedDualQuaternionBlend<'a> {
    /// Creates a pose from weights and one rigid transform per bone (rest model → posed model).
    ///
    /// # Errors
    /// As [`DualQuaternionBlend::new`](crate::skinning::DualQuaternionBlend::new).
    pub fn new(weights: &'a PackedWeights, transforms: &[Affine3A]) -> Result<Self, SkinningError> {
        let mut blend = Self::empty(weights);
        blend.set_transforms(transforms)?;
        Ok(blend)
    }

    /// Creates a pose from transforms that may stretch, in the two phases of
    /// [`DualQuaternionBlend::stretched`](crate::skinning::DualQuaternionBlend::stretched).
    ///
    /// # Errors
    /// As [`DualQuaternionBlend::stretched`](crate::skinning::DualQuaternionBlend::stretched).
    pub fn stretched(
        weights: &'a PackedWeights,
        transforms: &[Affine3A],
        pivots: &[Vec3],
    ) -> Result<Self, SkinningError> {
        let mut blend = Self::empty(weights);
        blend.set_stretched(transforms, pivots)?;
        Ok(blend)
    }

    fn empty(weights: &'a PackedWeights) -> Self {
        Self {
            weights,
            motions: BoneMotions::default(),
            #[cfg(target_arch = "x86_64")]
            lanes: Vec::new(),
            #[cfg(target_arch = "x86_64")]
            stretches: Vec::new(),
            portable: false,
        }
    }

    /// Sets another pose in the memory of this object.
    ///
    /// # Errors
    /// As [`new`](Self::new). The pose does not change then.
    pub fn set_transforms(&mut self, transforms: &[Affine3A]) -> Result<(), SkinningError> {
        self.motions
            .set_rigid(transforms, self.weights.bone_count())?;
        self.fill_lanes();
        Ok(())
    }

    /// Sets another pose that may stretch, in the memory of this object.
    ///
    /// # Errors
    /// As [`stretched`](Self::stretched). The pose does not change then.
    pub fn set_stretched(
        &mut self,
        transforms: &[Affine3A],
        pivots: &[Vec3],
    ) -> Result<(), SkinningError> {
        self.motions
            .set_stretched(transforms, pivots, self.weights.bone_count())?;
        self.fill_lanes();
        Ok(())
    }

    /// Converts the motions to the layout of the SIMD code.
    fn fill_lanes(&mut self) {
        #[cfg(target_arch = "x86_64")]
        {
            self.lanes.clear();
            let motions = self.motions.rigid.iter();
            let lane = |motion: &DualQuaternion| -> avx2::PackedDualQuaternion {
                bytemuck::cast([motion.real, motion.dual])
            };
            self.lanes.extend(motions.map(lane));
            self.stretches.clear();
            let stretches = self.motions.stretches.iter();
            self.stretches.extend(stretches.map(avx2::columns));
        }
    }

    /// Uses the portable code on all processors. Without this call it runs only on processors without AVX2.
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
        if !self.portable && kinopt_kinematics::processor::has_avx2_and_fma() {
            let palette = match &*self.stretches {
                [] => Palette::Motions(&self.lanes),
                stretches => Palette::Stretched(&self.lanes, stretches),
            };
            // SAFETY: the processor has AVX2 and FMA. The SIMD code measured four times as fast as the portable code.
            #[allow(unsafe_code)]
            return unsafe { avx2::deform(palette, influences, rest, posed) };
        }
        move_by_dual_quaternions(rest, posed, |index| {
            let influences = influences.vertices().get(index).into_iter();
            let influences = influences.flat_map(|four| four.iter());
            let mut sum = DualQuaternion::ZERO;
            let mut pivot = None;
            for (bone, weight) in influences.clone() {
                if let Some(motion) = self.motions.rigid.get(bone) {
                    let pivot = *pivot.get_or_insert(*motion);
                    sum = sum + motion.towards(pivot) * weight;
                }
            }
            (self.motions.stretch(influences), sum)
        });
    }
}
