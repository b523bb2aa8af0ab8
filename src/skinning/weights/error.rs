//! What may be wrong with skin weights.

/// How far the weights of one vertex may sum from 1. Files written with six digits and a dozen
/// influences are within it; weights that someone forgot to normalise are not.
pub const ROW_SUM_TOLERANCE: f64 = 1e-5;

/// How far below zero a weight may lie. Smooth weights computed by an optimiser undershoot by less;
/// beyond it skin visibly moves against its bone.
pub const NEGATIVE_TOLERANCE: f64 = 1e-2;

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
    /// A vertex has more influences than there is room for; [`SkinWeights::pruned`](super::SkinWeights::pruned) drops the
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
    /// Pruning would leave no influence.
    #[error("a vertex must keep at least one influence")]
    NoneKept,
    /// Packed weights number bones with 16 bits.
    #[error("{bones} bones, where packed weights have numbers for 65536")]
    TooManyBones {
        /// How many there are.
        bones: usize,
    },
}
