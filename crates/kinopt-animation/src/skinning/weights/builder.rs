//! Builder of skin weights, which checks or repairs them.

use super::{Influence, NEGATIVE_TOLERANCE, ROW_SUM_TOLERANCE, SkinWeights};
use crate::skinning::SkinningError;

/// Changes made by [`SkinWeightsBuilder::build_repaired`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WeightRepair {
    /// Number of negative weights set to 0.
    pub negative: usize,
    /// Number of vertices whose weights were divided by their sum, because it was not 1 within [`ROW_SUM_TOLERANCE`].
    pub rescaled: usize,
    /// Vertex and sum of the weights furthest from 1; `None` if no vertex was rescaled.
    pub worst: Option<(usize, f64)>,
}

impl WeightRepair {
    /// Reports whether nothing was changed.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

/// Collects (vertex, bone, weight) in any order and checks them.
#[derive(Clone, Debug)]
pub struct SkinWeightsBuilder {
    pub(super) vertex_count: usize,
    pub(super) bone_count: usize,
    pub(super) triples: Vec<(usize, Influence)>,
}

impl SkinWeightsBuilder {
    /// Adds one weight. A weight of exactly 0 is checked and left out.
    ///
    /// # Errors
    /// The weight is not finite, or the vertex or bone does not exist.
    pub fn add(&mut self, vertex: usize, bone: usize, weight: f64) -> Result<(), SkinningError> {
        if vertex >= self.vertex_count {
            return Err(SkinningError::VertexOutOfRange {
                vertex,
                vertices: self.vertex_count,
            });
        }
        let out_of_range = SkinningError::BoneOutOfRange {
            vertex,
            bone,
            bones: self.bone_count,
        };
        if bone >= self.bone_count {
            return Err(out_of_range);
        }
        if !weight.is_finite() {
            return Err(SkinningError::NonFiniteWeight {
                vertex,
                bone,
                weight,
            });
        }
        if weight != 0.0 {
            let bone = u32::try_from(bone).map_err(|_| out_of_range)?;
            self.triples.push((vertex, Influence { bone, weight }));
        }
        Ok(())
    }

    /// Builds sorted and checked weights.
    ///
    /// # Errors
    /// A vertex and bone occur twice, a weight is below −[`NEGATIVE_TOLERANCE`], or the weights of a vertex do not sum
    /// to 1.
    pub fn build(self) -> Result<SkinWeights, SkinningError> {
        self.rows(|vertex, influences| {
            let sum = sum(influences);
            if !sums_to_one(sum) {
                return Err(SkinningError::WeightSum { vertex, sum });
            }
            let negative = influences.iter().find(|i| i.weight < -NEGATIVE_TOLERANCE);
            negative.map_or(Ok(()), |low| {
                Err(SkinningError::NegativeWeight {
                    vertex,
                    bone: low.bone as usize,
                    weight: low.weight,
                })
            })
        })
    }

    /// Builds repaired weights and returns the changes: negative weights become 0, and weights that do not sum to 1 are
    /// divided by their sum.
    ///
    /// # Errors
    /// A vertex and bone occur twice, or the weights of a vertex sum to zero or overflow.
    pub fn build_repaired(self) -> Result<(SkinWeights, WeightRepair), SkinningError> {
        let mut repair = WeightRepair::default();
        let weights = self.rows(|vertex, influences| {
            let before = influences.len();
            influences.retain(|influence| influence.weight > 0.0);
            repair.negative += before - influences.len();
            let sum = sum(influences);
            if sums_to_one(sum) {
                return Ok(());
            }
            if !(sum.is_finite() && sum > 0.0) {
                return Err(SkinningError::WeightSum { vertex, sum });
            }
            for influence in influences {
                influence.weight /= sum;
            }
            repair.rescaled += 1;
            let is_worse = |(_, worst): (usize, f64)| (sum - 1.0).abs() > (worst - 1.0).abs();
            if repair.worst.is_none_or(is_worse) {
                repair.worst = Some((vertex, sum));
            }
            Ok(())
        })?;
        Ok((weights, repair))
    }

    /// Builds compressed sparse rows; `judge` checks or changes the influences of each vertex.
    fn rows(
        mut self,
        mut judge: impl FnMut(usize, &mut Vec<Influence>) -> Result<(), SkinningError>,
    ) -> Result<SkinWeights, SkinningError> {
        self.triples
            .sort_by_key(|&(vertex, influence)| (vertex, influence.bone));
        let mut starts = vec![0];
        let mut influences: Vec<Influence> = Vec::with_capacity(self.triples.len());
        // The loop ends early for a huge vertex count: a vertex without weights fails in `judge`.
        let mut triples = self.triples.iter().peekable();
        let mut row = Vec::new();
        for vertex in 0..self.vertex_count {
            row.clear();
            while let Some((_, influence)) = triples.next_if(|(owner, _)| *owner == vertex) {
                if row
                    .last()
                    .is_some_and(|last: &Influence| last.bone == influence.bone)
                {
                    return Err(SkinningError::DuplicateWeight {
                        vertex,
                        bone: influence.bone as usize,
                    });
                }
                row.push(*influence);
            }
            judge(vertex, &mut row)?;
            influences.extend_from_slice(&row);
            starts.push(influences.len());
        }
        Ok(SkinWeights {
            starts,
            influences,
            bone_count: self.bone_count,
        })
    }
}

fn sum(influences: &[Influence]) -> f64 {
    // `sum` returns −0 for an empty list.
    let weights = influences.iter().map(|influence| influence.weight);
    weights.fold(0.0, |sum, weight| sum + weight)
}

/// The comparison is false for NaN, the result of an overflow.
fn sums_to_one(sum: f64) -> bool {
    (sum - 1.0).abs() <= ROW_SUM_TOLERANCE
}
