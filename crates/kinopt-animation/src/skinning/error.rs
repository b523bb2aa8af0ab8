//! Errors of skinning.

use kinopt_kinematics::SizeMismatch;
use kinopt_mesh::mesh::MeshError;

/// Error of skinning a mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SkinningError {
    /// The number of transforms or pivots differs from the number of bones, or the length of a buffer from the number
    /// of vertices.
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
}
