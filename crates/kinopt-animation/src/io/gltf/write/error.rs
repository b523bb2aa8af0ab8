//! Errors of writing scenes.

use crate::animation::SizeMismatch;
use crate::io::gltf::scene::SceneError;

/// Error of writing a scene.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum UnwritableScene {
    /// The parts of a mesh do not match.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A clip belongs to another armature.
    #[error("clip `{clip}`: {problem}")]
    Clip {
        /// Name of the clip.
        clip: String,
        /// The difference in size.
        problem: SizeMismatch,
    },
    /// The file already has a clip of the name.
    #[error("clip name `{clip}` is used already; used names: {}", clips.join(", "))]
    ClipNameTaken {
        /// Name of the clip.
        clip: String,
        /// Names of all clips of the file.
        clips: Vec<String>,
    },
    /// A pose belongs to another armature.
    #[error("the pose does not fit the file's armature: {0}")]
    Pose(#[from] SizeMismatch),
    /// A mesh has no vertices or no triangles, which glTF does not allow.
    #[error("mesh `{mesh}`: there are no {what}")]
    Empty {
        /// Name of the mesh.
        mesh: String,
        /// `vertices` or `triangles`.
        what: &'static str,
    },
    /// Two meshes are on one bone, which glTF does not allow.
    #[error("bone `{bone}` has two meshes; a bone has at most one")]
    TwoMeshes {
        /// Name of the bone.
        bone: String,
    },
    /// A skin has more than 65536 joints; joint indices have 16 bits.
    #[error("mesh `{mesh}`: {joints} joints; a skin has at most 65536")]
    TooManyJoints {
        /// Name of the mesh.
        mesh: String,
        /// Number of joints.
        joints: usize,
    },
    /// The number of keys per second is not a finite number above 0.
    #[error("sample rate {0} keys/s: it must be a finite number above 0")]
    BadRate(f32),
    /// The up axis is zero or not finite.
    #[error("up axis {0:?}: it must be finite and not zero")]
    BadUp([f32; 3]),
    /// A curve would need too many keys.
    #[error("a curve would have {samples} keys, which is too many; reduce the sample rate")]
    TooManySamples {
        /// Number of keys.
        samples: f64,
    },
    /// The file exceeds 4 GiB, as GLB counts bytes with 32 bits.
    #[error("the file would have {bytes} bytes; GLB allows at most 4 GiB")]
    TooLong {
        /// Size in bytes.
        bytes: usize,
    },
    /// The document cannot be serialised.
    #[error("{0}")]
    Document(String),
}

impl From<serde_json::Error> for UnwritableScene {
    fn from(error: serde_json::Error) -> Self {
        Self::Document(error.to_string())
    }
}
