//! Fewer influences a vertex.

use super::{Influence, SkinWeights, WeightsError};

/// What [`SkinWeights::pruned`] dropped. Weights are shares of a vertex's motion, 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pruning {
    /// How many vertices lost influences.
    pub vertices: usize,
    /// The largest weight that one vertex lost, negative weights by their size.
    pub largest_lost: f64,
    /// The mean over all vertices of the weight lost.
    pub mean_lost: f64,
}

impl SkinWeights {
    /// The `most` influences of each vertex with the largest weights (of equal ones those of the lowest
    /// bones), divided by their sum, and what was lost. Vertices with fewer keep theirs to the bit.
    ///
    /// # Errors
    /// [`WeightsError::NoneKept`] for a `most` of 0.
    pub fn pruned(&self, most: usize) -> Result<(Self, Pruning), WeightsError> {
        if most == 0 {
            return Err(WeightsError::NoneKept);
        }
        let mut pruning = Pruning::default();
        let (mut rows, mut sum_lost) = (Vec::with_capacity(self.vertex_count()), 0.0);
        for influences in self.iter() {
            let mut kept = influences.to_vec();
            if kept.len() > most {
                // Not by size: with every negative weight goes a larger positive one, so that the
                // sum stays positive.
                kept.sort_by(|a, b| b.weight.total_cmp(&a.weight));
                let lost: f64 = kept.drain(most..).map(|i| i.weight.abs()).sum();
                kept.sort_by_key(|influence| influence.bone);
                let sum: f64 = kept.iter().map(|i| i.weight).sum();
                for influence in &mut kept {
                    influence.weight /= sum;
                }
                pruning.vertices += 1;
                pruning.largest_lost = pruning.largest_lost.max(lost);
                sum_lost += lost;
            }
            rows.push(kept);
        }
        if !rows.is_empty() {
            pruning.mean_lost = sum_lost / rows.len() as f64;
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
