//! Errors of morph targets.

use kinopt_kinematics::SizeMismatch;

/// Error of a morph target or its use.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MorphError {
    /// A target's list has a different length from its list of vertices.
    #[error("target `{target}`: {given} {what}s for {vertices} vertices")]
    DeltaCount {
        /// Name of the target.
        target: String,
        /// Name of the list: "normal delta" and so on.
        what: &'static str,
        /// Length of the list.
        given: usize,
        /// Number of vertices of the target.
        vertices: usize,
    },
    /// The vertices are not strictly ascending.
    #[error("target `{target}`: vertex {vertex} is out of order; vertices must increase")]
    Order {
        /// Name of the target.
        target: String,
        /// Index of the vertex.
        vertex: u32,
    },
    /// A delta is NaN or infinite.
    #[error("target `{target}`, vertex {vertex}: the {what} is not finite")]
    NonFinite {
        /// Name of the target.
        target: String,
        /// Name of the list: "position delta" and so on.
        what: &'static str,
        /// Index of the vertex in the mesh.
        vertex: u32,
    },
    /// A target refers to a vertex outside the mesh.
    #[error("target `{target}`: vertex {vertex} is out of range; there are {vertices} vertices")]
    VertexOutOfRange {
        /// Name of the target.
        target: String,
        /// Index of the vertex.
        vertex: u32,
        /// Number of vertices of the mesh.
        vertices: usize,
    },
    /// A shape has a different number of vertices from its mesh.
    #[error("target `{target}`: a shape of {given} vertices for a mesh of {vertices}")]
    ShapeCount {
        /// Name of the target.
        target: String,
        /// Number of vertices of the shape.
        given: usize,
        /// Number of vertices of the mesh.
        vertices: usize,
    },
    /// The number of weights differs from the number of targets.
    #[error("{given} weights for {targets} morph targets: {names}")]
    WeightCount {
        /// Number of weights.
        given: usize,
        /// Number of targets.
        targets: usize,
        /// Names of the targets.
        names: String,
    },
    /// A weight is NaN or infinite.
    #[error("target `{target}`: the weight {weight} is not finite")]
    NonFiniteWeight {
        /// Name of the target.
        target: String,
        /// The weight.
        weight: f32,
    },
    /// A vertex buffer is neither empty nor as long as the mesh.
    #[error(transparent)]
    Size(#[from] SizeMismatch),
}
