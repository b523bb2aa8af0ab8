//! Pruning of skin weights to fewer influences per vertex.

use super::{Influence, SkinWeights};
use crate::skinning::SkinningError;

/// Loss of [`SkinWeights::pruned`]. Weights are between 0 and 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pruning {
    /// Number of vertices that lost influences.
    pub vertices: usize,
    /// Largest weight that one vertex lost, as a sum of absolute weights.
    pub largest_lost: f64,
    /// Mean lost weight over all vertices.
    pub mean_lost: f64,
}

impl SkinWeights {
    /// Keeps the `most` largest weights of each vertex, divided by their sum, and returns the loss. Of equal weights it
    /// keeps those of the lowest bones. Vertices with fewer influences do not change.
    ///
    /// # Errors
    /// [`SkinningError::NoInfluences`] for a `most` of 0.
    pub fn pruned(&self, most: usize) -> Result<(Self, Pruning), SkinningError> {
        if most == 0 {
            return Err(SkinningError::NoInfluences);
        }
        let mut pruning = Pruning::default();
        let (mut rows, mut removed_sum) = (Vec::with_capacity(self.vertex_count()), 0.0);
        for influences in self.iter() {
            let mut row = influences.to_vec();
            if row.len() > most {
                // Signed order, not by size: negative weights are removed first, so the sum stays positive.
                row.sort_by(|a, b| b.weight.total_cmp(&a.weight));
                let removed: f64 = row.drain(most..).map(|i| i.weight.abs()).sum();
                row.sort_by_key(|influence| influence.bone);
                let sum: f64 = row.iter().map(|i| i.weight).sum();
                for influence in &mut row {
                    influence.weight /= sum;
                }
                pruning.vertices += 1;
                pruning.largest_lost = pruning.largest_lost.max(removed);
                removed_sum += removed;
            }
            rows.push(row);
        }
        if !rows.is_empty() {
            pruning.mean_lost = removed_sum / rows.len() as f64;
        }
        Ok((self.with_rows(&rows), pruning))
    }

    fn with_rows(&self, rows: &[Vec<Influence>]) -> Self {
        let mut starts = vec![0];
        let mut influences = Vec::new();
        for row in rows {
            influences.extend_from_slice(row);
            starts.push(influences.len());
        }
        Self {
            starts,
            influences,
            bone_count: self.bone_count,
        }
    }
}
