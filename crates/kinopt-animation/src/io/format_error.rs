//! Errors of writing motion as BVH, and of posing the meshes of rigs and scenes.

use super::WriteError;
#[cfg(feature = "gltf")]
use super::gltf::SceneError;
use crate::skinning::SkinningError;
use kinopt_kinematics::SizeMismatch;
use kinopt_kinematics::kinematics::KinematicsError;
use kinopt_mesh::mesh::MeshError;

/// Error of writing motion as BVH, or of posing the mesh of a rig or the meshes of a scene.
///
/// Frames are counted from 0.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FormatError {
    /// An armature without bones.
    #[error("the armature has no bones; a BVH file needs at least one root")]
    NoBones,
    /// A name that a reader would change.
    #[error(
        "bone `{bone}`: a name in a BVH file has no braces and no white space but single spaces \
         between words"
    )]
    Name {
        /// Name of the bone.
        bone: String,
    },
    /// A scaled bone; the format has no scales.
    #[error("bone `{bone}` is scaled {}; a BVH file has no scales", at(.frame))]
    Scaled {
        /// Name of the bone.
        bone: String,
        /// Frame of the scale; `None` at rest.
        frame: Option<usize>,
    },
    /// A transform that is not finite or beyond the range of the reader.
    #[error("bone `{bone}` {}: its transform must be finite and within 1e30 of its parent", at(.frame))]
    OutOfRange {
        /// Name of the bone.
        bone: String,
        /// Frame of the transform; `None` at rest.
        frame: Option<usize>,
    },
    /// Channels that a reader rejects.
    #[error(
        "bone `{bone}` has {fault}; a joint has each position at most once and at most three rotations"
    )]
    Channels {
        /// Name of the bone.
        bone: String,
        /// The first fault.
        fault: String,
    },
    /// A frame rate that is not positive and finite.
    #[error("frame rate {rate} frames/s: it must be finite and above 0")]
    Rate {
        /// Frames per second.
        rate: f64,
    },
    /// More frames than distinct times in single precision.
    #[error("{duration} s at {rate} frames/s: a BVH file has at most {most} frames")]
    TooManyFrames {
        /// Duration of the clip, seconds.
        duration: f64,
        /// Frames per second.
        rate: f64,
        /// Largest number of frames.
        most: usize,
    },
    /// The motion or the pose is of another armature or skeleton.
    #[error(transparent)]
    Size(#[from] SizeMismatch),
    /// The file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The rig has no mesh.
    #[error("the rig has no mesh")]
    NoMesh,
    /// The rig has no weights, and automatic weights failed.
    #[error("the rig has no skin weights, and they cannot be computed: {0}")]
    NoWeights(SkinningError),
    /// A configuration of another skeleton, or one that is not finite.
    #[error(transparent)]
    Kinematics(#[from] KinematicsError),
    /// An error of skinning the mesh of a rig.
    #[error(transparent)]
    Skinning(#[from] SkinningError),
    /// The parts of a scene's mesh do not match.
    #[cfg(feature = "gltf")]
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// An error of a mesh's skin, weights or morph targets; bone indices are indices of the skin's joints.
    #[error("mesh `{mesh}`: {problem}")]
    MeshSkinning {
        /// Name of the mesh.
        mesh: String,
        /// The problem.
        problem: SkinningError,
    },
    /// The posed vertices of a scene's mesh are not finite.
    #[error("mesh `{mesh}`: {problem}")]
    Mesh {
        /// Name of the mesh.
        mesh: String,
        /// The problem.
        problem: MeshError,
    },
}

fn at(frame: &Option<usize>) -> String {
    frame.map_or_else(|| "at rest".to_owned(), |frame| format!("in frame {frame}"))
}
