//! Errors of retargeting.

use crate::motion::trajectory::MotionError;
use kinopt_animation::animation::{ClipError, LayerError};
use kinopt_kinematics::bad_option::BadOption;
use kinopt_kinematics::model::{ModelError, UnknownName};

/// Reason why a motion cannot be retargeted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RetargetError {
    /// The capture or the model does not have the name.
    #[error(transparent)]
    Name(#[from] UnknownName),
    /// A number is out of its range.
    #[error(transparent)]
    Option(#[from] BadOption),
    /// The tasks or the trajectory problem are invalid.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// The bones do not form a valid skeleton, or the skeleton cannot be put on a free base.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The bones of the armature and the skeleton differ.
    #[error("the armature has bone `{given}` at the index of the skeleton's bone `{bone}`")]
    OtherBone {
        /// Bone of the armature; empty if it has fewer bones.
        given: String,
        /// Bone of the skeleton.
        bone: String,
    },
    /// The angles do not correspond to a pose.
    #[error(transparent)]
    Angles(#[from] LayerError),
    /// The bones cannot have that pose, or the poses do not form a valid clip.
    #[error(transparent)]
    Clip(#[from] ClipError),
    /// The count of numbers does not match whole capture frames.
    #[error(
        "the capture has {numbers} numbers: each frame needs three for each of the {joints} joints"
    )]
    NotFrames {
        /// Count of given numbers.
        numbers: usize,
        /// Number of joints.
        joints: usize,
    },
    /// A joint appears twice.
    #[error("joint `{joint}` is named twice")]
    NamedTwice {
        /// Name of the joint.
        joint: String,
    },
    /// A position is not finite.
    #[error("frame {frame}: the position of joint `{joint}` is not finite")]
    NotFinite {
        /// Index of the capture frame.
        frame: usize,
        /// Name of the joint.
        joint: String,
    },
    /// A position is too far from the origin.
    #[error(
        "frame {frame}: the position of joint `{joint}` is outside ±{most:e}",
        most = super::capture::MAX_COORDINATE
    )]
    TooFar {
        /// Index of the capture frame.
        frame: usize,
        /// Name of the joint.
        joint: String,
    },
    /// A count of rotations, rest positions or parents does not match the joints and frames.
    #[error("the capture has {given} {what}, expected {expected}")]
    RotationCount {
        /// Name of the list.
        what: &'static str,
        /// Given length.
        given: usize,
        /// Expected length.
        expected: usize,
    },
    /// A parent index is out of range, or the parents form a cycle.
    #[error("joint `{joint}`: its parent is not a joint, or is below the joint")]
    BadParent {
        /// Name of the joint.
        joint: String,
    },
    /// A rotation is not a unit quaternion, or a rest position is not finite.
    #[error(
        "{}: joint `{joint}` needs a finite position and a quaternion w, x, y, z of length 1",
        pose_name(*frame)
    )]
    BadRotation {
        /// Name of the joint.
        joint: String,
        /// Index of the capture frame; `None` in the rest pose.
        frame: Option<usize>,
    },
    /// The capture has no frames.
    #[error("the capture has no frames: at least one is needed")]
    NoFrames,
    /// A clip has too many samples.
    #[error(
        "{duration} s at {frame_rate} frames per second: at most {most} frames are allowed",
        most = super::capture::MAX_FRAMES
    )]
    TooManyFrames {
        /// Duration of the clip, seconds.
        duration: f64,
        /// Samples per second.
        frame_rate: f64,
    },
    /// The map assigns no frame of the model.
    #[error("the map drives no frame of `{model}`")]
    NoDrives {
        /// Name of the model.
        model: String,
    },
    /// Two joints drive one frame.
    #[error("frame `{frame}` is driven by both `{first}` and `{second}`")]
    DrivenTwice {
        /// Name of the frame.
        frame: String,
        /// First joint.
        first: String,
        /// Second joint.
        second: String,
    },
    /// The names match no body parts, so no map can be guessed.
    #[error("{of} match no body parts, so a map with `drives` is needed: {names}")]
    NoBody {
        /// Source of the names.
        of: &'static str,
        /// First names.
        names: String,
    },
    /// A map to a character lacks parts of the body.
    #[error("{of} lack {missing}: found {found}; a map with `drives` names them")]
    IncompleteBody {
        /// Source of the names.
        of: &'static str,
        /// Missing parts.
        missing: String,
        /// Parts found, each with its joint or frame.
        found: String,
    },
    /// Capture and model have too few parts in common.
    #[error("a capture with {capture} and a model with {model} have too few body parts in common")]
    NothingInCommon {
        /// Parts of the capture.
        capture: String,
        /// Parts of the model.
        model: String,
    },
    /// The capture lacks joints of the given skeleton.
    #[error("the joints are not those of skeleton `{skeleton}`: {joints}")]
    OtherSkeleton {
        /// Name of the skeleton.
        skeleton: &'static str,
        /// First joints of the capture.
        joints: String,
    },
    /// Markers of the set are missing.
    #[error("markers of Plug-in Gait are missing: {missing}; the file has {markers}")]
    MissingMarkers {
        /// Missing markers.
        missing: String,
        /// Markers of the file.
        markers: String,
    },
    /// The text of a terrain is invalid.
    #[error("terrain: {0}")]
    Terrain(String),
    /// The hand of the capture or of the robot is invalid.
    #[error("hand: {0}")]
    Hand(String),
    /// A held object is invalid.
    #[error("object: {0}")]
    Object(String),
    /// The text of a map is invalid.
    #[error("{0}")]
    Map(String),
}

impl RetargetError {
    /// Returns whether the error is in a map: its text, its numbers, or a name.
    #[must_use]
    pub fn is_of_map(&self) -> bool {
        match self {
            Self::Map(_)
            | Self::Name(_)
            | Self::NoDrives { .. }
            | Self::DrivenTwice { .. }
            | Self::NamedTwice { .. } => true,
            Self::Option(bad) => matches!(bad.option, "weight" | "scale" | "offset"),
            _ => false,
        }
    }
}

/// Returns the name of a pose of the capture, for a message.
fn pose_name(frame: Option<usize>) -> String {
    frame.map_or_else(|| "rest pose".to_owned(), |frame| format!("frame {frame}"))
}

impl From<kinopt_solver::problem::ProblemError> for RetargetError {
    fn from(error: kinopt_solver::problem::ProblemError) -> Self {
        Self::Motion(error.into())
    }
}
