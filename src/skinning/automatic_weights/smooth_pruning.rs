//! The strongest influences of each vertex, cut off without a tear.

use super::neighbours::Neighbours;
use crate::skinning::{SkinWeights, WeightsError};

/// A cut that takes less than this away leaves skin as smooth as it was.
const UNSEEN: f64 = 1e-2;
/// How often weights are evened out where they were cut.
const ROUNDS: usize = 10;

/// Collects weights a bone at a time and keeps the strongest of each point.
///
/// A plain cut makes skin tear: where two bones change places, the one that falls out takes all of its
/// weight away. So with t the largest weight that falls out, those that stay become
///
/// ```text
/// w_i' = (w_i − t² / w_i) / Σ_k (w_k − t² / w_k)
/// ```
///
/// which is nothing for a bone at the moment in which it falls out, and hardly less for one that is large
/// beside t. Where many bones are about as strong that is steep; so points near such a cut take the mean
/// of their own weights and those next to them and are cut again, a few times: a bone then fades towards
/// the end of its region.
pub(super) struct Strongest {
    rows: Vec<Row>,
    most: usize,
}

/// Bones and their weights, the largest first, of equal ones the earlier bone.
type Row = Vec<(usize, f64)>;

impl Strongest {
    pub(super) fn new(points: usize, most: usize) -> Self {
        Self {
            rows: vec![Row::new(); points],
            most,
        }
    }

    /// Adds a bone's weights of all points, none below 0.
    pub(super) fn add(&mut self, bone: usize, weights: impl IntoIterator<Item = f64>) {
        for (row, weight) in self.rows.iter_mut().zip(weights) {
            if weight > 0.0 {
                let place = row.partition_point(|(_, other)| *other >= weight);
                row.insert(place, (bone, weight));
                row.truncate(self.most.saturating_add(1));
            }
        }
    }

    /// The weights, with sums of 1; those of each vertex are those of the point that `point_of` says.
    pub(super) fn build(
        mut self,
        bones: usize,
        point_of: &[usize],
        neighbours: &Neighbours,
    ) -> Result<SkinWeights, WeightsError> {
        let mut lost: Vec<f64> = Vec::with_capacity(self.rows.len());
        lost.extend(self.rows.iter_mut().map(|row| cut(row, self.most)));
        for _ in 0..ROUNDS {
            let (before, lost_before) = (self.rows.clone(), lost);
            lost = vec![0.0; before.len()];
            for (point, others) in neighbours.rows().enumerate() {
                let near = others.iter().map(|other| lost_before[*other as usize]);
                if near.fold(lost_before[point], f64::max) > UNSEEN {
                    self.rows[point] = evened_out(&before, point, others);
                    lost[point] = cut(&mut self.rows[point], self.most);
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

/// ½ of a point's weights and ½ of the mean of those next to it.
fn evened_out(rows: &[Row], point: usize, others: &[u32]) -> Row {
    let mut all: Vec<(usize, f64)> = rows[point].iter().map(|(b, w)| (*b, 0.5 * w)).collect();
    let share = 0.5 / others.len().max(1) as f64;
    for other in others {
        all.extend(rows[*other as usize].iter().map(|(b, w)| (*b, share * w)));
    }
    all.sort_by_key(|(bone, _)| *bone);
    all.dedup_by(|second, first| {
        let same = second.0 == first.0;
        if same {
            first.1 += second.1;
        }
        same
    });
    all.sort_by(|a, b| b.1.total_cmp(&a.1));
    all
}

/// Cuts a row, and says what fell out.
fn cut(row: &mut Row, most: usize) -> f64 {
    let fallen = row.get(most).map_or(0.0, |(_, weight)| *weight);
    row.truncate(most);
    // Where all are equal there is nothing to fade to.
    let strongest = row.first().map_or(0.0, |(_, weight)| *weight);
    if fallen > 0.0 && strongest > fallen {
        row.retain_mut(|(_, weight)| {
            *weight -= fallen * fallen / *weight;
            *weight > 0.0
        });
    }
    let sum: f64 = row.iter().map(|(_, weight)| weight).sum();
    for (_, weight) in row {
        *weight /= sum;
    }
    fallen
}
