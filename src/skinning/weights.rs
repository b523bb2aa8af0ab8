//! How strongly each bone moves each vertex.

use nalgebra::DMatrix;

/// How far the weights of one vertex may sum from 1. Files written with six digits and a dozen
/// influences are within it; weights that someone forgot to normalise are not.
pub const ROW_SUM_TOLERANCE: f64 = 1e-5;

/// How far below zero a weight may lie. Smooth weights computed by an optimiser undershoot by less;
/// beyond it skin visibly moves against its bone.
pub const NEGATIVE_TOLERANCE: f64 = 1e-2;

/// One bone's share in the motion of a vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Influence {
    /// The bone's index in its skeleton.
    pub bone: u32,
    /// Its weight: about 0 to 1, but smooth weights from files may be slightly negative.
    pub weight: f64,
}

/// Sparse skin weights: for each vertex the bones that move it, any number of them, sorted by bone.
///
/// Each vertex's weights sum to 1 within [`ROW_SUM_TOLERANCE`]; they are kept exactly as given.
#[derive(Clone, Debug, PartialEq)]
pub struct SkinWeights {
    /// Where each vertex's influences start, and one past the last: compressed sparse rows.
    pub(super) starts: Vec<usize>,
    pub(super) influences: Vec<Influence>,
    pub(super) bone_count: usize,
}

/// What is wrong with a set of skin weights.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WeightsError {
    /// A weight is NaN or infinite.
    #[error("vertex {vertex}, bone {bone}: the weight {weight} is not finite")]
    NonFinite {
        /// Which vertex, from 0.
        vertex: usize,
        /// Which bone, from 0.
        bone: usize,
        /// The weight.
        weight: f64,
    },
    /// A weight names a bone that does not exist.
    #[error("vertex {vertex}: bone {bone} is out of range; there are {bones} bones")]
    BoneOutOfRange {
        /// Which vertex, from 0.
        vertex: usize,
        /// The bone it names.
        bone: usize,
        /// How many bones there are.
        bones: usize,
    },
    /// A weight names a vertex that does not exist.
    #[error("vertex {vertex} is out of range; there are {vertices} vertices")]
    VertexOutOfRange {
        /// The vertex it names.
        vertex: usize,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A weight is below zero by more than [`NEGATIVE_TOLERANCE`].
    #[error("vertex {vertex}, bone {bone}: the weight {weight} is negative")]
    Negative {
        /// Which vertex, from 0.
        vertex: usize,
        /// Which bone, from 0.
        bone: usize,
        /// The weight.
        weight: f64,
    },
    /// Two weights for the same vertex and bone.
    #[error("vertex {vertex}, bone {bone}: two weights are given")]
    Duplicate {
        /// Which vertex, from 0.
        vertex: usize,
        /// Which bone, from 0.
        bone: usize,
    },
    /// The weights of a vertex do not sum to 1.
    #[error("vertex {vertex}: the weights sum to {sum}, not to 1 within {ROW_SUM_TOLERANCE:e}")]
    Sum {
        /// Which vertex, from 0.
        vertex: usize,
        /// What they sum to.
        sum: f64,
    },
    /// A vertex has more influences than there is room for; [`SkinWeights::pruned`] drops the
    /// smallest and says what is lost.
    #[error(
        "vertex {vertex}: {influences} influences, where there is room for 4; prune them first"
    )]
    TooManyInfluences {
        /// Which vertex, from 0.
        vertex: usize,
        /// How many it has.
        influences: usize,
    },
    /// Packed weights number bones with 16 bits.
    #[error("{bones} bones, where packed weights have numbers for 65536")]
    TooManyBones {
        /// How many there are.
        bones: usize,
    },
}

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

impl SkinWeights {
    /// Starts collecting weights for so many vertices and bones. Nothing is allocated until
    /// weights are added.
    #[must_use]
    pub fn builder(vertex_count: usize, bone_count: usize) -> SkinWeightsBuilder {
        SkinWeightsBuilder {
            vertex_count,
            bone_count,
            triples: Vec::new(),
        }
    }

    /// Weights from a table with a row per vertex and a column per bone; zeros are left out.
    ///
    /// # Errors
    /// A [`WeightsError`] naming the vertex.
    pub fn from_table(table: &DMatrix<f64>) -> Result<Self, WeightsError> {
        let mut builder = Self::builder(table.nrows(), table.ncols());
        for (bone, column) in table.column_iter().enumerate() {
            for (vertex, &weight) in column.iter().enumerate() {
                builder.add(vertex, bone, weight)?;
            }
        }
        builder.build()
    }

    /// The table of [`from_table`](Self::from_table): a row per vertex, a column per bone.
    #[must_use]
    pub fn to_table(&self) -> DMatrix<f64> {
        let mut table = DMatrix::zeros(self.vertex_count(), self.bone_count);
        for (vertex, influences) in self.iter().enumerate() {
            for influence in influences {
                if let Some(entry) = table.get_mut((vertex, influence.bone as usize)) {
                    *entry = influence.weight;
                }
            }
        }
        table
    }

    /// How many vertices have weights.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// How many bones the skeleton has; all of [`Influence::bone`] are below it.
    #[must_use]
    pub fn bone_count(&self) -> usize {
        self.bone_count
    }

    /// The influences of one vertex, sorted by bone; empty when there is no such vertex.
    #[must_use]
    pub fn influences(&self, vertex: usize) -> &[Influence] {
        match (self.starts.get(vertex), self.starts.get(vertex + 1)) {
            (Some(&start), Some(&end)) => self.influences.get(start..end).unwrap_or(&[]),
            _ => &[],
        }
    }

    /// Every vertex's influences, in the order of the vertices.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[Influence]> {
        self.starts.windows(2).map(|ends| match ends {
            [start, end] => self.influences.get(*start..*end).unwrap_or(&[]),
            _ => &[],
        })
    }

    /// The largest number of influences on one vertex; 0 without vertices.
    #[must_use]
    pub fn max_influences(&self) -> usize {
        self.iter().map(<[_]>::len).max().unwrap_or(0)
    }
}

/// Collects (vertex, bone, weight) in any order and checks them.
#[derive(Clone, Debug)]
pub struct SkinWeightsBuilder {
    vertex_count: usize,
    bone_count: usize,
    triples: Vec<(usize, Influence)>,
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
    influences.iter().map(|influence| influence.weight).sum()
}

/// Asked this way round, so that a sum that overflowed to NaN is none.
fn sums_to_one(sum: f64) -> bool {
    (sum - 1.0).abs() <= ROW_SUM_TOLERANCE
}
