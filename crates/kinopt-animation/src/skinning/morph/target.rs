//! A morph target: differences of one shape from the rest shape.

use glam::Vec3;

use crate::skinning::SkinningError;
use kinopt_mesh::mesh::TriangleMesh;

/// Sparse differences of one shape from the rest shape.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MorphTarget {
    pub(super) name: String,
    pub(super) vertices: Vec<u32>,
    pub(super) positions: Vec<Vec3>,
    pub(super) normals: Vec<Vec3>,
    pub(super) tangents: Vec<Vec3>,
}

impl MorphTarget {
    /// Creates a target of sparse deltas: `vertices` in ascending order, with a position delta for each in the model's
    /// unit. Deltas of normals and tangents may be empty.
    ///
    /// # Errors
    /// The lists differ in length, the vertices do not ascend, or a number is not finite.
    pub fn new(
        name: impl Into<String>,
        vertices: Vec<u32>,
        positions: Vec<Vec3>,
        normals: Vec<Vec3>,
        tangents: Vec<Vec3>,
    ) -> Result<Self, SkinningError> {
        let target: String = name.into();
        let lists = [
            ("position delta", &positions, false),
            ("normal delta", &normals, true),
            ("tangent delta", &tangents, true),
        ];
        for (what, list, optional) in lists {
            if list.len() != vertices.len() && !(optional && list.is_empty()) {
                return Err(SkinningError::DeltaCount {
                    target,
                    what,
                    given: list.len(),
                    vertices: vertices.len(),
                });
            }
            let invalid = list.iter().zip(&vertices).find(|(d, _)| !d.is_finite());
            if let Some((_, &vertex)) = invalid {
                return Err(SkinningError::NonFiniteDelta {
                    target,
                    what,
                    vertex,
                });
            }
        }
        let descent = vertices.windows(2).find(|pair| pair[0] >= pair[1]);
        if let Some(&[_, vertex]) = descent {
            return Err(SkinningError::TargetOrder { target, vertex });
        }
        Ok(Self {
            name: target,
            vertices,
            positions,
            normals,
            tangents,
        })
    }

    /// The target whose full weight changes `rest` into `shape`: deltas of positions, and of normals if both meshes
    /// have them.
    ///
    /// A vertex is left out if neither its position nor its normal changes by more than `threshold` (positions in the
    /// model's unit). A threshold of 0 leaves out equal vertices only.
    ///
    /// # Errors
    /// The shape has a different number of vertices.
    pub fn between(
        name: impl Into<String>,
        rest: &TriangleMesh,
        shape: &TriangleMesh,
        threshold: f32,
    ) -> Result<Self, SkinningError> {
        let mut target = Self {
            name: name.into(),
            ..Self::default()
        };
        if shape.positions().len() != rest.positions().len() {
            return Err(SkinningError::TargetShapeCount {
                target: target.name,
                given: shape.positions().len(),
                vertices: rest.positions().len(),
            });
        }
        let with_normals = !rest.normals().is_empty() && !shape.normals().is_empty();
        let pairs = rest.positions().iter().zip(shape.positions());
        for (vertex, (from, to)) in pairs.enumerate() {
            let position_delta = *to - *from;
            let normals = (rest.normals().get(vertex), shape.normals().get(vertex));
            let normal_delta = match normals {
                (Some(from), Some(to)) => *to - *from,
                _ => Vec3::ZERO,
            };
            if position_delta.length() > threshold || normal_delta.length() > threshold {
                target.vertices.push(vertex as u32);
                target.positions.push(position_delta);
                if with_normals {
                    target.normals.push(normal_delta);
                }
            }
        }
        Ok(target)
    }

    /// Name of the target in clips and files.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Indices of the vertices with deltas, ascending.
    #[must_use]
    pub fn vertices(&self) -> &[u32] {
        &self.vertices
    }

    /// Position delta of each listed vertex, in the model's unit.
    #[must_use]
    pub fn position_deltas(&self) -> &[Vec3] {
        &self.positions
    }

    /// Normal delta of each listed vertex; empty if the target does not change normals.
    #[must_use]
    pub fn normal_deltas(&self) -> &[Vec3] {
        &self.normals
    }

    /// Tangent delta of each listed vertex; empty if the target does not change tangents.
    #[must_use]
    pub fn tangent_deltas(&self) -> &[Vec3] {
        &self.tangents
    }
}
