//! Bounding boxes of skinned meshes from their bones, without skinning.

use glam::{Affine3A, Vec3, Vec3A};

use super::bone_transform::check;
use super::{SkinWeights, SkinningError};
use kinopt_kinematics::SizeMismatch;

/// For each bone the box at rest of the vertices that it moves.
///
/// A vertex skinned by linear blend with non-negative weights is a weighted mean of T_j v̂. It therefore lies in the
/// common box of all transformed bone boxes. [`TriangleMesh::bounding_box`](kinopt_mesh::mesh::TriangleMesh::bounding_box) is
/// the exact box of a posed mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct BoneBoxes {
    boxes: Vec<Option<[Vec3; 2]>>,
    /// Largest Σ|w_j| − 1 of a vertex: the extrapolation by negative weights.
    excess: f32,
}

impl BoneBoxes {
    /// Creates the boxes from the mesh's positions at rest.
    ///
    /// # Errors
    /// The number of positions differs from the number of vertices of the weights, or a position is not finite.
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

    /// A box that contains every vertex skinned by linear blend with these transforms (rest → posed). The result is
    /// [lowest, highest] corner in the model's unit; `None` without vertices.
    ///
    /// The cost is per bone, not per vertex. The box is larger than the exact one. Vertices skinned by dual quaternions
    /// can leave it, as they move on arcs about joints.
    ///
    /// # Errors
    /// The number of transforms differs from the number of bones, or a transform is not finite.
    pub fn linear_blend(
        &self,
        transforms: &[Affine3A],
    ) -> Result<Option<[Vec3; 2]>, SkinningError> {
        check(transforms, self.boxes.len())?;
        let moved = self.boxes.iter().zip(transforms);
        let boxes =
            moved.filter_map(|(entry, transform)| Some(transformed_box(transform, (*entry)?)));
        let total_box = boxes.fold(None, |total_box, entry| Some(joined(total_box, entry)));
        Ok(total_box.map(|[low, high]| {
            // Margin for sums other than 1, negative weights and rounding.
            let largest = low.abs().max(high.abs()).max_element();
            let slack = self.excess * (high - low) + Vec3::splat(largest * 2e-5);
            [low - slack, high + slack]
        }))
    }
}

fn joined(total_box: Option<[Vec3; 2]>, [low, high]: [Vec3; 2]) -> [Vec3; 2] {
    total_box.map_or([low, high], |[l, h]| [l.min(low), h.max(high)])
}

/// Bounding box of a transformed box (Arvo 1990, "Transforming axis-aligned bounding boxes").
fn transformed_box(transform: &Affine3A, [low, high]: [Vec3; 2]) -> [Vec3; 2] {
    let (centre, half) = ((low + high) * 0.5, (high - low) * 0.5);
    let matrix = transform.matrix3;
    let reach =
        matrix.x_axis.abs() * half.x + matrix.y_axis.abs() * half.y + matrix.z_axis.abs() * half.z;
    let centre = transform.transform_point3a(Vec3A::from(centre));
    [(centre - reach).into(), (centre + reach).into()]
}
