//! Morph targets (blend shapes): shapes mixed into the mesh at rest, before bones move it.

mod error;
mod target;

pub use error::MorphError;
pub use target::MorphTarget;

use glam::{Vec3, Vec4};

use crate::SizeMismatch;

/// The morph targets of one mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct MorphTargets {
    targets: Vec<MorphTarget>,
    vertex_count: usize,
}

impl MorphTargets {
    /// Targets for a mesh of so many vertices.
    ///
    /// # Errors
    /// A target names a vertex that does not exist.
    pub fn new(vertex_count: usize, targets: Vec<MorphTarget>) -> Result<Self, MorphError> {
        for target in &targets {
            // They rise, so the last is the largest.
            let last = target.vertices.last();
            if let Some(&vertex) = last.filter(|&&v| v as usize >= vertex_count) {
                return Err(MorphError::VertexOutOfRange {
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

    /// No targets, for a mesh of so many vertices.
    #[must_use]
    pub fn none(vertex_count: usize) -> Self {
        Self {
            targets: Vec::new(),
            vertex_count,
        }
    }

    getters! {
        /// The targets, in the order of the weights.
        pub fn targets(&self) -> &[MorphTarget] = &self.targets;
        /// How many vertices the mesh has.
        pub fn vertex_count(&self) -> usize = self.vertex_count;
    }

    /// Adds Σ_k α_k Δ_k to vertices at rest, in place; buffers that are empty are left out. Normals and
    /// tangents that a target touches come out with unit length (zero where the sum is zero); tangents
    /// keep their sign w.
    ///
    /// Weights α_k are usually 0 to 1, but any finite number is taken; 0 costs nothing. The rest has
    /// the share 1 − Σ_k α_k, so this is the weighted mean of shapes whose weights sum to 1.
    ///
    /// # Errors
    /// There is not one weight per target, one is not finite, or a buffer is neither empty nor one
    /// entry per vertex. Nothing is changed then.
    pub fn apply(
        &self,
        weights: &[f32],
        positions: &mut [Vec3],
        normals: &mut [Vec3],
        tangents: &mut [Vec4],
    ) -> Result<(), MorphError> {
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
            let at = &target.vertices;
            add(positions, at, &target.positions, |p, by| *p += by * weight);
            add(normals, at, &target.normals, |n, by| *n += by * weight);
            add(tangents, at, &target.tangents, |t, by| {
                *t += (by * weight).extend(0.0)
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

    fn check_weights(&self, weights: &[f32]) -> Result<(), MorphError> {
        if weights.len() != self.targets.len() {
            let names: Vec<&str> = self.targets.iter().map(MorphTarget::name).collect();
            return Err(MorphError::WeightCount {
                given: weights.len(),
                targets: self.targets.len(),
                names: names.join(", "),
            });
        }
        let mut named = self.targets.iter().zip(weights);
        if let Some((target, &weight)) = named.find(|(_, weight)| !weight.is_finite()) {
            let target = target.name.clone();
            return Err(MorphError::NonFiniteWeight { target, weight });
        }
        Ok(())
    }
}

/// Does something to each listed vertex of a buffer that is there, with its delta.
fn add<T>(buffer: &mut [T], vertices: &[u32], deltas: &[Vec3], mut to: impl FnMut(&mut T, Vec3)) {
    for (&vertex, &delta) in vertices.iter().zip(deltas) {
        if let Some(entry) = buffer.get_mut(vertex as usize) {
            to(entry, delta);
        }
    }
}
