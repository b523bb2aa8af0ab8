//! Boxes around skinned meshes that need no skinning.

use glam::{Affine3A, Vec3, Vec3A};

use super::bone_transform::check;
use super::{SkinWeights, SkinningError};
use crate::SizeMismatch;

/// For each bone the box at rest of the vertices that it moves.
///
/// A vertex skinned by linear blend with weights of 0 or more is a weighted mean of T_j v̂, so it lies
/// within the box of all bones' moved boxes. The exact box of a posed mesh is
/// [`TriangleMesh::bounding_box`](crate::mesh::TriangleMesh::bounding_box).
#[derive(Clone, Debug, PartialEq)]
pub struct BoneBoxes {
    boxes: Vec<Option<[Vec3; 2]>>,
    /// Σ of a vertex's |w_j| less 1, at most: how far negative weights reach beyond the mean.
    excess: f32,
}

impl BoneBoxes {
    /// The boxes of a mesh's positions at rest.
    ///
    /// # Errors
    /// There is not one position per vertex of the weights, or one is not finite.
    pub fn new(weights: &SkinWeights, rest: &[Vec3]) -> Result<Self, SkinningError> {
        SizeMismatch::check("rest positions", rest.len(), weights.vertex_count())?;
        if let Some(vertex) = rest.iter().position(|p| !p.is_finite()) {
            return Err(SkinningError::NonFinitePosition { vertex });
        }
        let mut boxes = vec![None; weights.bone_count()];
        let mut excess = 0.0_f64;
        for (&position, influences) in rest.iter().zip(weights.iter()) {
            let size: f64 = influences.iter().map(|i| i.weight.abs()).sum();
            excess = excess.max(size - 1.0);
            for influence in influences {
                if let Some(entry) = boxes.get_mut(influence.bone as usize) {
                    *entry = Some(joined(*entry, [position, position]));
                }
            }
        }
        Ok(Self {
            boxes,
            excess: excess as f32,
        })
    }

    /// A box that holds every vertex skinned by linear blend with these transforms (rest → posed),
    /// as [lowest, highest] corner in the model's unit; `None` without vertices. It takes time per
    /// bone, not per vertex, and is larger than the exact box.
    ///
    /// Dual quaternions may leave it: they swing vertices on arcs about the joint.
    ///
    /// # Errors
    /// There is not one transform per bone, or one is not finite.
    pub fn linear_blend(
        &self,
        transforms: &[Affine3A],
    ) -> Result<Option<[Vec3; 2]>, SkinningError> {
        check(transforms, self.boxes.len())?;
        let moved = self.boxes.iter().zip(transforms);
        let boxes = moved.filter_map(|(entry, transform)| Some(moved_box(transform, (*entry)?)));
        let whole = boxes.fold(None, |whole, entry| Some(joined(whole, entry)));
        Ok(whole.map(|[low, high]| {
            // Weights off from 1, weights below zero, and rounding.
            let largest = low.abs().max(high.abs()).max_element();
            let slack = self.excess * (high - low) + Vec3::splat(largest * 2e-5);
            [low - slack, high + slack]
        }))
    }
}

fn joined(whole: Option<[Vec3; 2]>, [low, high]: [Vec3; 2]) -> [Vec3; 2] {
    whole.map_or([low, high], |[l, h]| [l.min(low), h.max(high)])
}

/// The box of a moved box (Arvo 1990, "Transforming axis-aligned bounding boxes").
fn moved_box(transform: &Affine3A, [low, high]: [Vec3; 2]) -> [Vec3; 2] {
    let (centre, half) = ((low + high) * 0.5, (high - low) * 0.5);
    let matrix = transform.matrix3;
    let reach =
        matrix.x_axis.abs() * half.x + matrix.y_axis.abs() * half.y + matrix.z_axis.abs() * half.z;
    let centre = transform.transform_point3a(Vec3A::from(centre));
    [(centre - reach).into(), (centre + reach).into()]
}
