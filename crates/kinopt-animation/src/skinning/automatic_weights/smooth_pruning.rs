//! Pruning of skin weights to the strongest influences, with smooth transitions.

use super::neighbours::Neighbours;
use crate::skinning::{SkinWeights, SkinningError};

/// Largest removed weight that needs no smoothing.
const MAX_UNSMOOTHED_WEIGHT: f64 = 1e-2;
/// Number of smoothing rounds near removed weights.
const SMOOTHING_ROUNDS: usize = 10;

/// Collects weights bone by bone and keeps the strongest of each point.
///
/// Plain pruning makes steps in the skin: at the boundary between two bones' regions a removed bone takes its whole
/// weight away. With t the largest removed weight, the kept weights therefore become
///
/// ```text
/// w_i' = (w_i − t² / w_i) / Σ_k (w_k − t² / w_k)
/// ```
///
/// This is 0 for a bone at the boundary of its region, and nearly w_i for a weight much larger than t. The transition
/// is steep if many bones have similar weights. Points near removed weights are therefore smoothed with their
/// neighbours and pruned again, in several rounds.
pub(super) struct Strongest {
    rows: Vec<VertexInfluences>,
    max_influences: usize,
}

/// Bones and weights by descending weight; the earlier bone first among equals.
type VertexInfluences = Vec<(usize, f64)>;

impl Strongest {
    pub(super) fn new(points: usize, max_influences: usize) -> Self {
        Self {
            rows: vec![VertexInfluences::new(); points],
            max_influences,
        }
    }

    /// Adds the weights of one bone for all points, none below 0.
    pub(super) fn add(&mut self, bone: usize, weights: impl IntoIterator<Item = f64>) {
        for (row, weight) in self.rows.iter_mut().zip(weights) {
            if weight > 0.0 {
                let index = row.partition_point(|(_, other)| *other >= weight);
                row.insert(index, (bone, weight));
                row.truncate(self.max_influences.saturating_add(1));
            }
        }
    }

    /// Builds the normalised weights. `point_of` is the point index of each vertex.
    pub(super) fn build(
        mut self,
        bones: usize,
        point_of: &[usize],
        neighbours: &Neighbours,
    ) -> Result<SkinWeights, SkinningError> {
        let mut removed: Vec<f64> = Vec::with_capacity(self.rows.len());
        removed.extend(
            self.rows
                .iter_mut()
                .map(|row| cut(row, self.max_influences)),
        );
        for _ in 0..SMOOTHING_ROUNDS {
            let (before, removed_before) = (self.rows.clone(), removed);
            removed = vec![0.0; before.len()];
            for (point, others) in neighbours.rows().enumerate() {
                let nearby = others.iter().map(|other| removed_before[*other as usize]);
                if nearby.fold(removed_before[point], f64::max) > MAX_UNSMOOTHED_WEIGHT {
                    self.rows[point] = smoothed(&before, point, others);
                    removed[point] = cut(&mut self.rows[point], self.max_influences);
                }
            }
        }
        let mut builder = SkinWeights::builder(point_of.len(), bones);
        for (vertex, point) in point_of.iter().enumerate() {
            let row = self.rows.get(*point).map_or(&[][..], Vec::as_slice);
            for &(bone, weight) in row {
                builder.add(vertex, bone, weight)?;
            }
        }
        builder.build()
    }
}

/// ½ of a point's weights plus ½ of the mean of its neighbours.
fn smoothed(rows: &[VertexInfluences], point: usize, others: &[u32]) -> VertexInfluences {
    let mut entries: Vec<(usize, f64)> = rows[point].iter().map(|(b, w)| (*b, 0.5 * w)).collect();
    let factor = 0.5 / others.len().max(1) as f64;
    for other in others {
        entries.extend(rows[*other as usize].iter().map(|(b, w)| (*b, factor * w)));
    }
    entries.sort_by_key(|(bone, _)| *bone);
    entries.dedup_by(|second, first| {
        let is_duplicate = second.0 == first.0;
        if is_duplicate {
            first.1 += second.1;
        }
        is_duplicate
    });
    entries.sort_by(|a, b| b.1.total_cmp(&a.1));
    entries
}

/// Prunes a row and returns the largest removed weight.
fn cut(row: &mut VertexInfluences, max_influences: usize) -> f64 {
    let largest_removed = row.get(max_influences).map_or(0.0, |(_, weight)| *weight);
    row.truncate(max_influences);
    // Equal weights have no transition to smooth.
    let strongest = row.first().map_or(0.0, |(_, weight)| *weight);
    if largest_removed > 0.0 && strongest > largest_removed {
        row.retain_mut(|(_, weight)| {
            *weight -= largest_removed * largest_removed / *weight;
            *weight > 0.0
        });
    }
    let sum: f64 = row.iter().map(|(_, weight)| weight).sum();
    for (_, weight) in row {
        *weight /= sum;
    }
    largest_removed
}
