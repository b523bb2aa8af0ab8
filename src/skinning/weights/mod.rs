//! How strongly each bone moves each vertex.

mod builder;
mod error;

use nalgebra::DMatrix;

pub use builder::{SkinWeightsBuilder, WeightRepair};
pub use error::{NEGATIVE_TOLERANCE, ROW_SUM_TOLERANCE, WeightsError};

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

    getters! {
        /// How many vertices have weights.
        pub fn vertex_count(&self) -> usize = self.starts.len().saturating_sub(1);
        /// How many bones the skeleton has; all of [`Influence::bone`] are below it.
        pub fn bone_count(&self) -> usize = self.bone_count;
        /// The largest number of influences on one vertex; 0 without vertices.
        pub fn max_influences(&self) -> usize = self.iter().map(<[_]>::len).max().unwrap_or(0);
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
}
