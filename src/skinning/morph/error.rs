//! What may be wrong with morph targets.

use crate::SizeMismatch;

/// What is wrong with a morph target or its use.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MorphError {
    /// A target's lists are not as long as its list of vertices.
    #[error("target `{target}`: {given} {what}s for {vertices} vertices")]
    DeltaCount {
        /// The target's name.
        target: String,
        /// "normal delta", …
        what: &'static str,
        /// How many there are.
        given: usize,
        /// How many vertices the target lists.
        vertices: usize,
    },
    /// The vertices are not listed in rising order, each once.
    #[error("target `{target}`: vertex {vertex} does not come after the one before it")]
    Order {
        /// The target's name.
        target: String,
        /// The vertex.
        vertex: u32,
    },
    /// A delta is NaN or infinite.
    #[error("target `{target}`, vertex {vertex}: the {what} is not finite")]
    NonFinite {
        /// The target's name.
        target: String,
        /// "position delta", …
        what: &'static str,
        /// Which vertex of the mesh.
        vertex: u32,
    },
    /// A target names a vertex that the mesh does not have.
    #[error("target `{target}`: vertex {vertex} is out of range; there are {vertices} vertices")]
    VertexOutOfRange {
        /// The target's name.
        target: String,
        /// The vertex it names.
        vertex: u32,
        /// How many there are.
        vertices: usize,
    },
    /// A shape has another number of vertices than the mesh it is taken from.
    #[error("target `{target}`: a shape of {given} vertices for a mesh of {vertices}")]
    ShapeCount {
        /// The target's name.
        target: String,
        /// How many the shape has.
        given: usize,
        /// How many the mesh has.
        vertices: usize,
    },
    /// There is not one weight per target.
    #[error("{given} weights for {targets} morph targets: {names}")]
    WeightCount {
        /// How many weights.
        given: usize,
        /// How many targets.
        targets: usize,
        /// The targets' names.
        names: String,
    },
    /// A weight is NaN or infinite.
    #[error("target `{target}`: the weight {weight} is not finite")]
    NonFiniteWeight {
        /// The target's name.
        target: String,
        /// The weight.
        weight: f32,
    },
    /// A buffer of vertices is neither empty nor as long as the mesh.
    #[error(transparent)]
    Size(#[from] SizeMismatch),
}
