//! Morph targets (blend shapes): shapes blended into the mesh at rest, before skinning.

mod target;

pub use target::MorphTarget;

use glam::{Vec3, Vec4};

use crate::skinning::SkinningError;
use kinopt_kinematics::SizeMismatch;

/// The morph targets of one mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct MorphTargets {
    targets: Vec<MorphTarget>,
    vertex_count: usize,
}

impl MorphTargets {
    /// Creates the targets of a mesh with `vertex_count` vertices.
    ///
    /// # Errors
    /// A target refers to a vertex outside the mesh.
    pub fn new(vertex_count: usize, targets: Vec<MorphTarget>) -> Result<Self, SkinningError> {
        for target in &targets {
            // The indices ascend, so the last is the largest.
            let last = target.vertices.last();
            if let Some(&vertex) = last.filter(|&&v| v as usize >= vertex_count) {
                return Err(SkinningError::TargetVertexOutOfRange {
                    target: target.name.clone(),
                    vertex,
                    vertices: vertex_count,
                });
            }
        }
        Ok(Self {
            targets,
            vertex_count,
        })
    }

    /// No targets, for a mesh with `vertex_count` vertices.
    #[must_use]
    pub fn none(vertex_count: usize) -> Self {
        Self {
            targets: Vec::new(),
            vertex_count,
        }
    }

    /// The targets, in the order of the weights.
    #[must_use]
    pub fn targets(&self) -> &[MorphTarget] {
        &self.targets
    }

    /// Number of vertices of the mesh.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// Adds Σ_k α_k Δ_k to vertices at rest, in place. Empty buffers are skipped. Normals and tangents that a target
    /// changes are normalised, or zero if the sum is zero. Tangents keep their sign w.
    ///
    /// Weights α_k are usually between 0 and 1, but may be any finite numbers; targets of weight 0 cost nothing. The
    /// rest shape has the weight 1 − Σ_k α_k, so the result is the weighted mean of shapes whose weights sum to 1.
    ///
    /// # Errors
    /// The number of weights differs from the number of targets, or a weight is not finite. Also a buffer that is
    /// neither empty nor as long as the mesh. Nothing changes then.
    pub fn apply(
        &self,
        weights: &[f32],
        positions: &mut [Vec3],
        normals: &mut [Vec3],
        tangents: &mut [Vec4],
    ) -> Result<(), SkinningError> {
        self.check_weights(weights)?;
        let sizes = [
            ("positions", positions.len()),
            ("normals", normals.len()),
            ("tangents", tangents.len()),
        ];
        for (what, given) in sizes {
            if given != 0 {
                SizeMismatch::check(what, given, self.vertex_count)?;
            }
        }
        let active = || self.targets.iter().zip(weights).filter(|(_, w)| **w != 0.0);
        for (target, &weight) in active() {
            let vertices = &target.vertices;
            add(positions, vertices, &target.positions, |p, delta| {
                *p += delta * weight
            });
            add(normals, vertices, &target.normals, |n, delta| {
                *n += delta * weight
            });
            add(tangents, vertices, &target.tangents, |t, delta| {
                *t += (delta * weight).extend(0.0)
            });
        }
        for (target, _) in active() {
            add(normals, &target.vertices, &target.normals, |n, _| {
                *n = n.normalize_or_zero();
            });
            add(tangents, &target.vertices, &target.tangents, |t, _| {
                *t = t.truncate().normalize_or_zero().extend(t.w);
            });
        }
        Ok(())
    }

    fn check_weights(&self, weights: &[f32]) -> Result<(), SkinningError> {
        if weights.len() != self.targets.len() {
            let names: Vec<&str> = self.targets.iter().map(MorphTarget::name).collect();
            return Err(SkinningError::TargetWeightCount {
                given: weights.len(),
                targets: self.targets.len(),
                names: names.join(", "),
            });
        }
        let mut named = self.targets.iter().zip(weights);
        if let Some((target, &weight)) = named.find(|(_, weight)| !weight.is_finite()) {
            let target = target.name.clone();
            return Err(SkinningError::NonFiniteTargetWeight { target, weight });
        }
        Ok(())
    }
}

/// Calls `to` for each listed vertex of a buffer with its delta.
fn add<T>(buffer: &mut [T], vertices: &[u32], deltas: &[Vec3], mut to: impl FnMut(&mut T, Vec3)) {
    for (&vertex, &delta) in vertices.iter().zip(deltas) {
        if let Some(entry) = buffer.get_mut(vertex as usize) {
            to(entry, delta);
        }
    }
}
