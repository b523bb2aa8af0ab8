//! Linear blend skinning with packed weights.

use glam::Affine3A;

use super::PackedWeights;
#[cfg(target_arch = "x86_64")]
use super::avx2::{self, Palette};
use crate::skinning::bone_transform::check;
use crate::skinning::linear_blend::move_by_matrices;
use crate::skinning::{Deformation, PosedVertices, RestVertices, SkinningError};

/// [`LinearBlend`](crate::skinning::LinearBlend) for at most four influences per vertex. The results agree up to
/// rounding.
///
/// It blends eight vertices at a time on processors with AVX2 and FMA, and one at a time on others.
#[derive(Clone, Debug)]
pub struct PackedLinearBlend<'a> {
    weights: &'a PackedWeights,
    transforms: Vec<Affine3A>,
    #[cfg(target_arch = "x86_64")]
    columns: Vec<avx2::Columns>,
    portable: bool,
}

impl<'a> PackedLinearBlend<'a> {
    /// Creates a pose from weights and one transform per bone (rest model → posed model), as
    /// [`LinearBlend`](crate::skinning::LinearBlend) does.
    ///
    /// # Errors
    /// The number of transforms differs from the number of bones, or a transform is not finite.
    pub fn new(weights: &'a PackedWeights, transforms: &[Affine3A]) -> Result<Self, SkinningError> {
        let mut blend = Self {
            weights,
            transforms: Vec::new(),
            #[cfg(target_arch = "x86_64")]
            columns: Vec::new(),
            portable: false,
        };
        blend.set_transforms(transforms)?;
        Ok(blend)
    }

    /// Sets another pose in the memory of this object.
    ///
    /// # Errors
    /// As [`new`](Self::new). The pose does not change then.
    pub fn set_transforms(&mut self, transforms: &[Affine3A]) -> Result<(), SkinningError> {
        check(transforms, self.weights.bone_count())?;
        transforms.clone_into(&mut self.transforms);
        #[cfg(target_arch = "x86_64")]
        {
            self.columns.clear();
            self.columns.extend(transforms.iter().map(avx2::columns));
        }
        Ok(())
    }

    /// Uses the portable code on all processors. Without this call it runs only on processors without AVX2.
    #[must_use]
    pub fn portable(mut self) -> Self {
        self.portable = true;
        self
    }
}

impl Deformation for PackedLinearBlend<'_> {
    fn vertex_count(&self) -> usize {
        self.weights.vertex_count()
    }

    fn deform_range(&self, first: usize, rest: RestVertices<'_>, posed: PosedVertices<'_>) {
        let influences = self.weights.part(first, rest.len());
        #[cfg(target_arch = "x86_64")]
        if !self.portable && crate::processor::has_avx2_and_fma() {
            let palette = Palette::Matrices(&self.columns);
            // SAFETY: the processor has AVX2 and FMA. The SIMD code measured more than twice as fast as the portable
            // code.
            #[allow(unsafe_code)]
            return unsafe { avx2::deform(palette, influences, rest, posed) };
        }
        move_by_matrices(rest, posed, |index| {
            let mut sum = Affine3A::ZERO;
            let vertex_influences = influences.vertices().get(index).into_iter();
            for (bone, weight) in vertex_influences.flat_map(|four| four.iter()) {
                if let Some(transform) = self.transforms.get(bone) {
                    sum.matrix3 += transform.matrix3 * weight;
                    sum.translation += transform.translation * weight;
                }
            }
            sum
        });
    }
}
