//! Linear blend skinning: each vertex moves by the weighted mean of its bones' transforms.

use glam::Affine3A;

use super::bone_transform::check;
use super::directions::{transformed_normal, transformed_tangent};
use super::{Deformation, Influence, PosedVertices, RestVertices, SkinWeights, SkinningError};

/// One pose by linear blend skinning: v' = Σ_j w_j T_j v̂. Normals use the inverse transpose of the blended matrix,
/// tangents the matrix itself.
///
/// It works in single precision with any number of influences. The error of a vertex is a few units in the last place
/// of the largest coordinate involved, in the model's frame. A vertex without influences moves to the origin, the value
/// of the empty sum. [`PackedLinearBlend`](super::PackedLinearBlend) is faster, for at most four influences.
#[derive(Clone, Copy, Debug)]
pub struct LinearBlend<'a> {
    weights: &'a SkinWeights,
    transforms: &'a [Affine3A],
}

impl<'a> LinearBlend<'a> {
    /// Creates a pose from weights and one transform per bone (rest model → posed model).
    /// [`single_precision_transform`](super::single_precision_transform) converts the results of
    /// [`skinning_transforms`](kinopt_kinematics::skeleton::BonePlacements::skinning_transforms).
    ///
    /// # Errors
    /// The number of transforms differs from the number of bones, or a transform is not finite.
    pub fn new(
        weights: &'a SkinWeights,
        transforms: &'a [Affine3A],
    ) -> Result<Self, SkinningError> {
        check(transforms, weights.bone_count())?;
        Ok(Self {
            weights,
            transforms,
        })
    }

    /// Σ_j w_j T_j.
    fn blended(&self, influences: &[Influence]) -> Affine3A {
        let mut sum = Affine3A::ZERO;
        for influence in influences {
            // The weights are checked, so bones are in range.
            if let Some(transform) = self.transforms.get(influence.bone as usize) {
                let weight = influence.weight as f32;
                sum.matrix3 += transform.matrix3 * weight;
                sum.translation += transform.translation * weight;
            }
        }
        sum
    }
}

impl Deformation for LinearBlend<'_> {
    fn vertex_count(&self) -> usize {
        self.weights.vertex_count()
    }

    fn deform_range(&self, first: usize, rest: RestVertices<'_>, posed: PosedVertices<'_>) {
        move_by_matrices(rest, posed, |index| {
            self.blended(self.weights.influences(first + index))
        });
    }
}

/// Deforms vertices by transforms, which `blended` returns for a buffer index.
pub(super) fn move_by_matrices(
    rest: RestVertices<'_>,
    posed: PosedVertices<'_>,
    blended: impl Fn(usize) -> Affine3A,
) {
    for vertex in 0..rest.len() {
        let transform = blended(vertex);
        if let (Some(p), Some(out)) = (rest.positions.get(vertex), posed.positions.get_mut(vertex))
        {
            *out = transform.transform_point3(*p);
        }
        if let (Some(n), Some(out)) = (rest.normals.get(vertex), posed.normals.get_mut(vertex)) {
            *out = transformed_normal(&transform.matrix3, *n);
        }
        if let (Some(t), Some(out)) = (rest.tangents.get(vertex), posed.tangents.get_mut(vertex)) {
            *out = transformed_tangent(&transform.matrix3, *t);
        }
    }
}
