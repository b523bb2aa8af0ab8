//! Why a scene cannot be written.

use crate::animation::SizeMismatch;
use crate::io::gltf::scene::SceneError;

/// Why a scene cannot be written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum UnwritableScene {
    /// The parts of a mesh do not go together.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A clip of another armature.
    #[error("clip `{clip}`: {problem}")]
    Clip {
        /// The clip.
        clip: String,
        /// How it differs.
        problem: SizeMismatch,
    },
    /// A clip that is called like one of the file's.
    #[error("the file has a clip `{clip}` already; names taken are {}", clips.join(", "))]
    ClipNameTaken {
        /// The name.
        clip: String,
        /// All names that are taken.
        clips: Vec<String>,
    },
    /// A pose of another armature.
    #[error("the pose is not the file's: {0}")]
    Pose(#[from] SizeMismatch),
    /// A mesh without vertices or triangles, which glTF does not have.
    #[error("mesh `{mesh}`: there are no {what}")]
    Empty {
        /// The mesh.
        mesh: String,
        /// Vertices or triangles.
        what: &'static str,
    },
    /// Two meshes hang on one bone, which glTF does not have.
    #[error("bone `{bone}` has two meshes; join them, or give one a bone of its own")]
    TwoMeshes {
        /// The bone.
        bone: String,
    },
    /// More joints than vertices can tell apart.
    #[error("mesh `{mesh}`: {joints} joints, where there are numbers for 65536")]
    TooManyJoints {
        /// The mesh.
        mesh: String,
        /// How many joints it has.
        joints: usize,
    },
    /// A number of keys a second that is none.
    #[error("{0} keys a second; it must be a finite number above 0")]
    BadRate(f32),
    /// An axis up without a direction.
    #[error("the axis up, {0:?}, is not finite or has no direction")]
    BadUp([f32; 3]),
    /// A curve so long that it would take more keys than anyone wants.
    #[error("a curve would take {samples} keys; ask for fewer a second")]
    TooManySamples {
        /// How many.
        samples: f64,
    },
    /// GLB counts bytes with 32 bits.
    #[error("the file would take {bytes} bytes, beyond the 4 GiB that GLB can have")]
    TooLong {
        /// How many.
        bytes: usize,
    },
    /// The document cannot be put into words.
    #[error("{0}")]
    Document(String),
}

impl From<serde_json::Error> for UnwritableScene {
    fn from(error: serde_json::Error) -> Self {
        Self::Document(error.to_string())
    }
}
