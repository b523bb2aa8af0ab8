//! Errors of skinning, skin weights, morph targets, key shapes, cages and volumes.

use super::weights::ROW_SUM_TOLERANCE;
use kinopt_kinematics::SizeMismatch;
use kinopt_mesh::mesh::MeshError;

/// Error of skinning a mesh, or of its weights, morph targets, key shapes, cage or volumes.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SkinningError {
    /// A slice has a wrong length: transforms or pivots of bones, or buffers of vertices.
    #[error(transparent)]
    Size(#[from] SizeMismatch),
    /// A bone's transform contains NaN or infinity.
    #[error("bone {bone}: the transform is not finite")]
    NonFiniteTransform {
        /// Index of the bone, from 0.
        bone: usize,
    },
    /// A position at rest is NaN or infinite.
    #[error("vertex {vertex}: the position at rest is not finite")]
    NonFinitePosition {
        /// Index of the vertex, from 0.
        vertex: usize,
    },
    /// A bone's pivot is NaN or infinite.
    #[error("bone {bone}: the pivot is not finite")]
    NonFinitePivot {
        /// Index of the bone, from 0.
        bone: usize,
    },
    /// A transform is not rigid; dual quaternions represent rotations and translations only.
    #[error(
        "bone {bone}: the transform scales, shears or mirrors, which a dual quaternion cannot represent; \
         use `DualQuaternionBlend::stretched` with pivots, or linear blend"
    )]
    NotRigid {
        /// Index of the bone, from 0.
        bone: usize,
    },
    /// A transform mirrors and those of most bones do not.
    #[error(
        "bone {bone}: the transform mirrors and those of most bones do not; it must contain a rotation"
    )]
    Mirrored {
        /// Index of the bone, from 0.
        bone: usize,
    },
    /// A quaternion has length zero or is NaN, so it is no rotation.
    #[error("quaternion ({w}, {x}, {y}, {z}): it must be finite and not zero")]
    ZeroQuaternion {
        /// Real part.
        w: f32,
        /// First imaginary part.
        x: f32,
        /// Second imaginary part.
        y: f32,
        /// Third imaginary part.
        z: f32,
    },
    /// The posed mesh contains a number that is not finite in single precision.
    #[error("the posed mesh: {0}")]
    Mesh(#[from] MeshError),
    /// A skin weight is NaN or infinite.
    #[error("vertex {vertex}, bone {bone}: the weight {weight} is not finite")]
    NonFiniteWeight {
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
    /// A weight is below −[`NEGATIVE_TOLERANCE`](super::NEGATIVE_TOLERANCE).
    #[error("vertex {vertex}, bone {bone}: the weight {weight} is negative")]
    NegativeWeight {
        /// Index of the vertex, from 0.
        vertex: usize,
        /// Index of the bone, from 0.
        bone: usize,
        /// The weight.
        weight: f64,
    },
    /// A vertex has two weights for one bone.
    #[error("vertex {vertex}, bone {bone}: two weights are given")]
    DuplicateWeight {
        /// Index of the vertex, from 0.
        vertex: usize,
        /// Index of the bone, from 0.
        bone: usize,
    },
    /// The weights of a vertex do not sum to 1.
    #[error("vertex {vertex}: the weights sum to {sum}, not to 1 within {ROW_SUM_TOLERANCE:e}")]
    WeightSum {
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
    /// The largest number of influences is 0.
    #[error("a vertex must keep at least one influence")]
    NoInfluences,
    /// Packed weights store bone indices in 16 bits.
    #[error("{bones} bones; packed weights have at most 65536")]
    TooManyBones {
        /// Number of bones.
        bones: usize,
    },
    /// The skeleton has no bones.
    #[error("there are no bones")]
    NoBones,
    /// The falloff is not a finite number above 0.
    #[error("falloff {0}: it must be finite and above 0")]
    Falloff(f64),
    /// The heat factor is not a finite number above 0.
    #[error("heat {0}: it must be finite and above 0")]
    Heat(f64),
    /// An end of a bone is NaN or infinite.
    #[error("bone {bone}: an end is not finite")]
    NonFiniteBone {
        /// Index of the bone, from 0.
        bone: usize,
    },
    /// The heat equations of the surface cannot be solved in double precision.
    #[error("the heat on this surface cannot be computed in double precision")]
    Unsolvable,
    /// A morph target's list has a different length from its list of vertices.
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
    /// The vertices of a morph target are not strictly ascending.
    #[error("target `{target}`: vertex {vertex} is out of order; vertices must increase")]
    TargetOrder {
        /// Name of the target.
        target: String,
        /// Index of the vertex.
        vertex: u32,
    },
    /// A delta of a morph target is NaN or infinite.
    #[error("target `{target}`, vertex {vertex}: the {what} is not finite")]
    NonFiniteDelta {
        /// Name of the target.
        target: String,
        /// Name of the list: "position delta" and so on.
        what: &'static str,
        /// Index of the vertex in the mesh.
        vertex: u32,
    },
    /// A morph target refers to a vertex outside the mesh.
    #[error("target `{target}`: vertex {vertex} is out of range; there are {vertices} vertices")]
    TargetVertexOutOfRange {
        /// Name of the target.
        target: String,
        /// Index of the vertex.
        vertex: u32,
        /// Number of vertices of the mesh.
        vertices: usize,
    },
    /// The shape of a morph target has a different number of vertices from its mesh.
    #[error("target `{target}`: a shape of {given} vertices for a mesh of {vertices}")]
    TargetShapeCount {
        /// Name of the target.
        target: String,
        /// Number of vertices of the shape.
        given: usize,
        /// Number of vertices of the mesh.
        vertices: usize,
    },
    /// The number of weights differs from the number of morph targets.
    #[error("{given} weights for {targets} morph targets: {names}")]
    TargetWeightCount {
        /// Number of weights.
        given: usize,
        /// Number of targets.
        targets: usize,
        /// Names of the targets.
        names: String,
    },
    /// The weight of a morph target is NaN or infinite.
    #[error("target `{target}`: the weight {weight} is not finite")]
    NonFiniteTargetWeight {
        /// Name of the target.
        target: String,
        /// The weight.
        weight: f32,
    },
    /// There are no key shapes.
    #[error("there are no shapes")]
    NoShapes,
    /// Two key shapes have the same name.
    #[error("the shape name `{shape}` is used twice")]
    DuplicateShape {
        /// Name of the shape.
        shape: String,
    },
    /// A key shape has a different number of vertices from the first.
    #[error("shape `{shape}`: {given} vertices, but the first shape has {vertices}")]
    ShapeCount {
        /// Name of the shape.
        shape: String,
        /// Number of vertices of the shape.
        given: usize,
        /// Number of vertices of the first shape.
        vertices: usize,
    },
    /// A position of a key shape is NaN or infinite.
    #[error("shape `{shape}`, vertex {vertex}: the position is not finite")]
    NonFiniteShape {
        /// Name of the shape.
        shape: String,
        /// Index of the vertex, from 0.
        vertex: usize,
    },
    /// The number of weights differs from the number of key shapes.
    #[error("{given} weights for {shapes} shapes: {names}")]
    ShapeWeightCount {
        /// Number of weights.
        given: usize,
        /// Number of shapes.
        shapes: usize,
        /// Names of the shapes.
        names: String,
    },
    /// The weight of a key shape is NaN or infinite.
    #[error("shape `{shape}`: the weight {weight} is not finite")]
    NonFiniteShapeWeight {
        /// Name of the shape.
        shape: String,
        /// The weight.
        weight: f32,
    },
    /// The weights of key shapes do not sum to 1, so a blend of equal shapes would differ from them.
    #[error("the weights sum to {sum}, not to 1 within {ROW_SUM_TOLERANCE:e}")]
    ShapeWeightSum {
        /// Sum of the weights.
        sum: f64,
    },
    /// The triangles of a cage do not bound a solid: an edge has no neighbour, or there are no triangles.
    #[error("the cage is not closed: every edge must be used once in each direction")]
    NotClosed,
    /// A triangle of a cage has no area.
    #[error("the cage's triangle {triangle} has no area")]
    FlatTriangle {
        /// Index of the triangle, from 0.
        triangle: usize,
    },
    /// A point of a cage binding is NaN or infinite.
    #[error("point {point} is not finite")]
    NonFinitePoint {
        /// Index of the point, from 0.
        point: usize,
    },
    /// The weights of a point sum to zero, so it has no coordinates. This occurs outside cages only.
    #[error("point {point} is outside the cage")]
    NoCoordinates {
        /// Index of the point, from 0.
        point: usize,
    },
    /// The mesh of a volume has holes or no inside.
    #[error("the mesh must be closed and enclose a volume")]
    OpenMesh,
}
