//! Collects weights, and checks or repairs them.

use super::{Influence, NEGATIVE_TOLERANCE, ROW_SUM_TOLERANCE, SkinWeights, WeightsError};

/// What [`SkinWeightsBuilder::build_repaired`] changed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WeightRepair {
    /// How many weights below zero became zero.
    pub negative: usize,
    /// How many vertices' weights were divided by their sum, because it was not 1 within
    /// [`ROW_SUM_TOLERANCE`].
    pub rescaled: usize,
    /// The sum that was furthest from 1, and whose vertex; `None` when none was rescaled.
    pub worst: Option<(usize, f64)>,
}

impl WeightRepair {
    /// Whether the weights were right as they were given.
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
    /// Adds one weight; a weight of exactly zero is checked and left out.
    ///
    /// # Errors
    /// A [`WeightsError`] when the weight is not finite or the vertex or bone does not exist.
    pub fn add(&mut self, vertex: usize, bone: usize, weight: f64) -> Result<(), WeightsError> {
        if vertex >= self.vertex_count {
            return Err(WeightsError::VertexOutOfRange {
                vertex,
                vertices: self.vertex_count,
            });
        }
        let out_of_range = WeightsError::BoneOutOfRange {
            vertex,
            bone,
            bones: self.bone_count,
        };
        if bone >= self.bone_count {
            return Err(out_of_range);
        }
        if !weight.is_finite() {
            return Err(WeightsError::NonFinite {
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

    /// The weights, sorted and checked.
    ///
    /// # Errors
    /// A [`WeightsError`] when a vertex and bone occur twice, a weight is below zero by more than
    /// [`NEGATIVE_TOLERANCE`], or a vertex's weights do not sum to 1.
    pub fn build(self) -> Result<SkinWeights, WeightsError> {
        self.rows(|vertex, influences| {
            let sum = sum(influences);
            if !sums_to_one(sum) {
                return Err(WeightsError::Sum { vertex, sum });
            }
            let negative = influences.iter().find(|i| i.weight < -NEGATIVE_TOLERANCE);
            negative.map_or(Ok(()), |low| {
                Err(WeightsError::Negative {
                    vertex,
                    bone: low.bone as usize,
                    weight: low.weight,
                })
            })
        })
    }

    /// The weights, repaired where that has one meaning: weights below zero become zero, and weights
    /// that do not sum to 1 are divided by their sum. What was done comes with them.
    ///
    /// # Errors
    /// A vertex and bone occur twice, or a vertex's weights sum to zero or overflow.
    pub fn build_repaired(self) -> Result<(SkinWeights, WeightRepair), WeightsError> {
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
                return Err(WeightsError::Sum { vertex, sum });
            }
            for influence in influences {
                influence.weight /= sum;
            }
            repair.rescaled += 1;
            let further = |(_, worst): (usize, f64)| (sum - 1.0).abs() > (worst - 1.0).abs();
            if repair.worst.is_none_or(further) {
                repair.worst = Some((vertex, sum));
            }
            Ok(())
        })?;
        Ok((weights, repair))
    }

    /// Compressed rows of the triples, each vertex's influences judged or mended on the way.
    fn rows(
        mut self,
        mut judge: impl FnMut(usize, &mut Vec<Influence>) -> Result<(), WeightsError>,
    ) -> Result<SkinWeights, WeightsError> {
        self.triples
            .sort_by_key(|&(vertex, influence)| (vertex, influence.bone));
        let mut starts = vec![0];
        let mut influences: Vec<Influence> = Vec::with_capacity(self.triples.len());
        // Each vertex must take at least one triple, so this ends after as many as were added even
        // when an absurd vertex count was announced.
        let mut triples = self.triples.iter().peekable();
        let mut row = Vec::new();
        for vertex in 0..self.vertex_count {
            row.clear();
            while let Some((_, influence)) = triples.next_if(|(owner, _)| *owner == vertex) {
                if row
                    .last()
                    .is_some_and(|last: &Influence| last.bone == influence.bone)
                {
                    return Err(WeightsError::Duplicate {
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
    // Not `sum`, which makes −0 of nothing.
    let weights = influences.iter().map(|influence| influence.weight);
    weights.fold(0.0, |sum, weight| sum + weight)
}

/// Asked this way round, so that a sum that overflowed to NaN is none.
fn sums_to_one(sum: f64) -> bool {
    (sum - 1.0).abs() <= ROW_SUM_TOLERANCE
}
