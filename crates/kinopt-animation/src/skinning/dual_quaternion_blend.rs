//! Dual quaternion skinning: vertices keep their distance from a twisted joint.

use glam::{Affine3A, Vec3, Vec4};

use super::bone_motions::BoneMotions;
use super::directions::{transformed_normal, transformed_tangent};
use super::{
    Deformation, DualQuaternion, Influence, PosedVertices, RestVertices, SkinWeights, SkinningError,
};

/// One pose by dual quaternion blending: q̂ = Σ_j ±w_j q̂_j, divided by the norm of its real part.
///
/// Sources: Kavan, Collins, Žára & O'Sullivan, "Skinning with dual quaternions" (2007) and "Geometric skinning with
/// approximate dual quaternion blending" (2008). The sign moves each q̂_j to the hemisphere of the bone with the
/// largest weight, the first among equals. Blending then takes the short arc.
///
/// It works in single precision with any number of influences.
/// [`PackedDualQuaternionBlend`](super::PackedDualQuaternionBlend) is faster, for at most four influences.
#[derive(Clone, Debug)]
pub struct DualQuaternionBlend<'a> {
    weights: &'a SkinWeights,
    motions: BoneMotions,
}

impl<'a> DualQuaternionBlend<'a> {
    /// Creates a pose from weights and one rigid transform per bone (rest model → posed model).
    ///
    /// # Errors
    /// The number of transforms differs from the number of bones, or a transform is not finite. Also a transform that
    /// scales, shears or mirrors by more than 1e-4, unless all bones share the scale.
    pub fn new(weights: &'a SkinWeights, transforms: &[Affine3A]) -> Result<Self, SkinningError> {
        let motions = BoneMotions::rigid(transforms, weights.bone_count())?;
        Ok(Self { weights, motions })
    }

    /// Creates a pose from transforms that may stretch, in two phases. Stretches are blended linearly at rest, each
    /// about its bone's pivot: the tail of the bone at rest, in the model's unit. The remaining rigid motions are
    /// blended as dual quaternions. A bone of scale 0, or flattened along an axis, collapses its vertices as in linear
    /// blending.
    ///
    /// # Errors
    /// The number of transforms or pivots differs from the number of bones, or a number is not finite. Also a transform
    /// that mirrors, if those of most bones do not.
    pub fn stretched(
        weights: &'a SkinWeights,
        transforms: &[Affine3A],
        pivots: &[Vec3],
    ) -> Result<Self, SkinningError> {
        let motions = BoneMotions::stretched(transforms, pivots, weights.bone_count())?;
        Ok(Self { weights, motions })
    }

    /// Σ_j ±w_j q̂_j.
    fn blended(&self, influences: &[Influence]) -> DualQuaternion {
        let mut sum = DualQuaternion::ZERO;
        let motion = |influence: &Influence| self.motions.rigid.get(influence.bone as usize);
        let Some(pivot) = heaviest(influences).and_then(motion) else {
            return sum;
        };
        for influence in influences {
            if let Some(motion) = motion(influence) {
                sum = sum + motion.towards(*pivot) * influence.weight as f32;
            }
        }
        sum
    }
}

/// The influence with the largest weight; the first among equals.
fn heaviest(influences: &[Influence]) -> Option<&Influence> {
    let influences = influences.iter();
    influences.reduce(|best, next| {
        if next.weight > best.weight {
            next
        } else {
            best
        }
    })
}

impl Deformation for DualQuaternionBlend<'_> {
    fn vertex_count(&self) -> usize {
        self.weights.vertex_count()
    }

    fn deform_range(&self, first: usize, rest: RestVertices<'_>, posed: PosedVertices<'_>) {
        move_by_dual_quaternions(rest, posed, |index| {
            let influences = self.weights.influences(first + index);
            let bone_weights = influences.iter();
            let bone_weights =
                bone_weights.map(|influence| (influence.bone as usize, influence.weight as f32));
            (self.motions.stretch(bone_weights), self.blended(influences))
        });
    }
}

/// Deforms vertices by a stretch and a rigid motion, which `blended` returns for a buffer index.
pub(super) fn move_by_dual_quaternions(
    rest: RestVertices<'_>,
    posed: PosedVertices<'_>,
    blended: impl Fn(usize) -> (Option<Affine3A>, DualQuaternion),
) {
    for vertex in 0..rest.len() {
        let (stretch, motion) = blended(vertex);
        let matrix = stretch.map_or(glam::Mat3A::IDENTITY, |stretch| stretch.matrix3);
        if let (Some(&p), Some(out)) = (rest.positions.get(vertex), posed.positions.get_mut(vertex))
        {
            let p = stretch.map_or(p, |stretch| stretch.transform_point3(p));
            *out = motion.transform_point(p);
        }
        if let (Some(&n), Some(out)) = (rest.normals.get(vertex), posed.normals.get_mut(vertex)) {
            *out = motion.transform_vector(transformed_normal(&matrix, n));
        }
        if let (Some(&t), Some(out)) = (rest.tangents.get(vertex), posed.tangents.get_mut(vertex)) {
            let t = transformed_tangent(&matrix, t);
            let rotated = motion.transform_vector(t.truncate());
            *out = Vec4::from((rotated, t.w));
        }
    }
}
