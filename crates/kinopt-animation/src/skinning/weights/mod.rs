//! Skin weights: the influence of each bone on each vertex.

mod builder;
mod tolerances;

use crate::skinning::SkinningError;
use nalgebra::DMatrix;

pub use builder::{SkinWeightsBuilder, WeightRepair};
pub use tolerances::{NEGATIVE_TOLERANCE, ROW_SUM_TOLERANCE};

/// Influence of one bone on a vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Influence {
    /// Index of the bone in its skeleton.
    pub bone: u32,
    /// Weight, usually between 0 and 1. Smooth weights from files may be slightly negative.
    pub weight: f64,
}

/// Sparse skin weights: for each vertex any number of influences, sorted by bone.
///
/// The weights of each vertex sum to 1 within [`ROW_SUM_TOLERANCE`]. They are stored exactly as given.
#[derive(Clone, Debug, PartialEq)]
pub struct SkinWeights {
    /// Start of each vertex's influences, and the end of the last: compressed sparse rows.
    pub(super) starts: Vec<usize>,
    pub(super) influences: Vec<Influence>,
    pub(super) bone_count: usize,
}

impl SkinWeights {
    /// Starts a builder for a number of vertices and bones. Adding weights allocates; this call does not.
    #[must_use]
    pub fn builder(vertex_count: usize, bone_count: usize) -> SkinWeightsBuilder {
        SkinWeightsBuilder {
            vertex_count,
            bone_count,
            triples: Vec::new(),
        }
    }

    /// Creates weights from a table with a row per vertex and a column per bone. Zeros are left out.
    ///
    /// # Errors
    /// A [`SkinningError`] that names the vertex.
    pub fn from_table(table: &DMatrix<f64>) -> Result<Self, SkinningError> {
        let mut builder = Self::builder(table.nrows(), table.ncols());
        for (bone, column) in table.column_iter().enumerate() {
            for (vertex, &weight) in column.iter().enumerate() {
                builder.add(vertex, bone, weight)?;
            }
        }
        builder.build()
    }

    /// The weights as a table with a row per vertex and a column per bone; the inverse of
    /// [`from_table`](Self::from_table).
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

    /// Number of vertices.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// Number of bones; every [`Influence::bone`] is below it.
    #[must_use]
    pub fn bone_count(&self) -> usize {
        self.bone_count
    }

    /// Largest number of influences of a vertex; 0 without vertices.
    #[must_use]
    pub fn max_influences(&self) -> usize {
        self.iter().map(<[_]>::len).max().unwrap_or(0)
    }

    /// Influences of one vertex, sorted by bone; empty for an unknown vertex.
    #[must_use]
    pub fn influences(&self, vertex: usize) -> &[Influence] {
        match (self.starts.get(vertex), self.starts.get(vertex + 1)) {
            (Some(&start), Some(&end)) => self.influences.get(start..end).unwrap_or(&[]),
            _ => &[],
        }
    }

    /// Influences of every vertex, in the order of the vertices.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[Influence]> {
        self.starts.windows(2).map(|ends| match ends {
            [start, end] => self.influences.get(*start..*end).unwrap_or(&[]),
            _ => &[],
        })
    }
}
