//! What can be wrong with a request to move skin.

use crate::SizeMismatch;
use crate::mesh::MeshError;

/// Why a mesh cannot be skinned.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SkinningError {
    /// Transforms or pivots for another number of bones than the weights know, or a buffer for another
    /// number of vertices.
    #[error(transparent)]
    Size(#[from] SizeMismatch),
    /// A bone's transform holds NaN or an infinity.
    #[error("bone {bone}: the transform holds a number that is not finite")]
    NonFiniteTransform {
        /// Which bone, from 0.
        bone: usize,
    },
    /// A position at rest is NaN or infinite.
    #[error("vertex {vertex}: the position at rest is not finite")]
    NonFinitePosition {
        /// Which vertex, from 0.
        vertex: usize,
    },
    /// A bone's pivot is NaN or infinite.
    #[error("bone {bone}: the pivot is not finite")]
    NonFinitePivot {
        /// Which bone, from 0.
        bone: usize,
    },
    /// Dual quaternions hold rotations and translations only.
    #[error(
        "bone {bone}: the transform scales, shears or mirrors, which a dual quaternion cannot say; \
         give the pivots for stretching apart (`DualQuaternionBlend::stretched`) or use linear blend"
    )]
    NotRigid {
        /// Which bone, from 0.
        bone: usize,
    },
    /// A transform mirrors or flattens space, so it is no rotation after a stretch, and the other bones do not mirror.
    #[error("bone {bone}: the transform mirrors or flattens space, so no rotation is in it")]
    Mirrored {
        /// Which bone, from 0.
        bone: usize,
    },
    /// A quaternion of length zero (or NaN) is no rotation.
    #[error("the quaternion {w}, {x}, {y}, {z} has no direction, so it is no rotation")]
    ZeroQuaternion {
        /// Its real part.
        w: f32,
        /// Its first imaginary part.
        x: f32,
        /// Its second imaginary part.
        y: f32,
        /// Its third imaginary part.
        z: f32,
    },
    /// The posed mesh holds a number that is not finite in single precision.
    #[error("the posed mesh: {0}")]
    Mesh(#[from] MeshError),
}
