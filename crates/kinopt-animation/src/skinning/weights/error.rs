//! Errors of skin weights.

/// Largest deviation from 1 of the sum of a vertex's weights. Files with six digits and a dozen influences are within
/// it; weights that are not normalised are not.
pub const ROW_SUM_TOLERANCE: f64 = 1e-5;

/// Largest absolute value of a negative weight. Smooth weights of an optimiser undershoot by less; larger values move
/// skin visibly against its bone.
pub const NEGATIVE_TOLERANCE: f64 = 1e-2;

/// Error of skin weights.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WeightsError {
    /// A weight is NaN or infinite.
    #[error("vertex {vertex}, bone {bone}: the weight {weight} is not finite")]
    NonFinite {
        /// Index of the vertex, from 0.
        vertex: usize,
        /// Index of the bone, from 0.
        bone: usize,
        /// The weight.
        weight: f64,
    },
    /// A weight refers to a bone that does not exist.
    #[error("vertex {vertex}: bone {bone} is out of range; there are {bones} bones")]
    BoneOutOfRange {
        /// Index of the vertex, from 0.
        vertex: usize,
        /// Index of the bone.
        bone: usize,
        /// Number of bones.
        bones: usize,
    },
    /// A weight refers to a vertex that does not exist.
    #[error("vertex {vertex} is out of range; there are {vertices} vertices")]
    VertexOutOfRange {
        /// Index of the vertex.
        vertex: usize,
        /// Number of vertices.
        vertices: usize,
    },
    /// A weight is below −[`NEGATIVE_TOLERANCE`].
    #[error("vertex {vertex}, bone {bone}: the weight {weight} is negative")]
    Negative {
        /// Index of the vertex, from 0.
        vertex: usize,
        /// Index of the bone, from 0.
        bone: usize,
        /// The weight.
        weight: f64,
    },
    /// A vertex has two weights for one bone.
    #[error("vertex {vertex}, bone {bone}: two weights are given")]
    Duplicate {
        /// Index of the vertex, from 0.
        vertex: usize,
        /// Index of the bone, from 0.
        bone: usize,
    },
    /// The weights of a vertex do not sum to 1.
    #[error("vertex {vertex}: the weights sum to {sum}, not to 1 within {ROW_SUM_TOLERANCE:e}")]
    Sum {
        /// Index of the vertex, from 0.
        vertex: usize,
        /// Sum of the weights.
        sum: f64,
    },
    /// A vertex has too many influences for packed weights. [`SkinWeights::pruned`](super::SkinWeights::pruned) removes
    /// the smallest and returns the loss.
    #[error(
        "vertex {vertex}: {influences} influences; packed weights have at most 4 (prune them first)"
    )]
    TooManyInfluences {
        /// Index of the vertex, from 0.
        vertex: usize,
        /// Number of influences of the vertex.
        influences: usize,
    },
    /// Pruning to 0 influences.
    #[error("a vertex must keep at least one influence")]
    NoneKept,
    /// Packed weights store bone indices in 16 bits.
    #[error("{bones} bones; packed weights have at most 65536")]
    TooManyBones {
        /// Number of bones.
        bones: usize,
    },
}
