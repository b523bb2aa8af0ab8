//! What can be wrong with a capture, a map, or what is asked of both.

use crate::animation::{ChannelError, LocalError, ReachError};
use crate::bad_option::BadOption;
use crate::model::{ModelError, UnknownName};
use crate::motion::clip::MotionError;
use crate::skeleton::SkeletonError;

/// Why a movement cannot be brought onto a model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RetargetError {
    /// A name that the capture or the model does not have.
    #[error(transparent)]
    Name(#[from] UnknownName),
    /// A number out of its range.
    #[error(transparent)]
    Option(#[from] BadOption),
    /// What the tasks of a frame, or the whole motion, refuse.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// Bones that make no figure.
    #[error(transparent)]
    Skeleton(#[from] SkeletonError),
    /// A figure that cannot be put on a free base.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// An armature whose bones are not the figure's.
    #[error("the armature has bone `{given}` where the figure has `{bone}`")]
    OtherBone {
        /// The armature's, empty where it has no more.
        given: String,
        /// The figure's.
        bone: String,
    },
    /// Bones that cannot stand so.
    #[error(transparent)]
    Pose(#[from] LocalError),
    /// Angles that no pose is of.
    #[error(transparent)]
    Angles(#[from] ReachError),
    /// Poses that make no clip.
    #[error(transparent)]
    Clip(#[from] ChannelError),
    /// Numbers that are no places of so many joints.
    #[error("{numbers} numbers are no places of {joints} joints in whole frames")]
    NotFrames {
        /// How many numbers are given.
        numbers: usize,
        /// How many joints are named.
        joints: usize,
    },
    /// A joint named twice.
    #[error("joint `{joint}` is named twice")]
    NamedTwice {
        /// The joint.
        joint: String,
    },
    /// A place that is not finite.
    #[error("frame {frame}: the place of joint `{joint}` is not finite")]
    NotFinite {
        /// The frame.
        frame: usize,
        /// The joint.
        joint: String,
    },
    /// A place where no body is.
    #[error(
        "frame {frame}: the place of joint `{joint}` is beyond ±{most:e}",
        most = super::capture::FARTHEST
    )]
    TooFar {
        /// The frame.
        frame: usize,
        /// The joint.
        joint: String,
    },
    /// A capture without frames.
    #[error("a capture of no frames")]
    NoFrames,
    /// So many frames of a clip that memory would not do.
    #[error(
        "{duration} s at {frame_rate} frames a second are more than {most} frames",
        most = super::capture::MOST_FRAMES
    )]
    TooManyFrames {
        /// How long the clip is, s.
        duration: f64,
        /// Frames a second.
        frame_rate: f64,
    },
    /// A map that drives nothing.
    #[error("the map drives no frame of `{model}`")]
    NoDrives {
        /// The model.
        model: String,
    },
    /// A frame that two joints drive.
    #[error("frame `{frame}` is driven by both `{first}` and `{second}`")]
    DrivenTwice {
        /// The frame.
        frame: String,
        /// One joint.
        first: String,
        /// The other.
        second: String,
    },
    /// Names that tell of no body, so that no map can be guessed.
    #[error("{of} tell of no body, so a map must say which joint drives which frame: {names}")]
    NoBody {
        /// Whose names.
        of: &'static str,
        /// The first of them.
        names: String,
    },
    /// A capture and a model that have too few parts in common.
    #[error("a capture of {capture} and a model of {model} have too little in common")]
    NothingInCommon {
        /// The capture's parts.
        capture: String,
        /// The model's.
        model: String,
    },
    /// A capture without some joint of the skeleton that it is said to be.
    #[error("these are not the joints of `{skeleton}`: {joints}")]
    OtherSkeleton {
        /// The skeleton.
        skeleton: &'static str,
        /// The first of the capture's joints.
        joints: String,
    },
    /// A map's text that is none.
    #[error("{0}")]
    Map(String),
}

impl RetargetError {
    /// Whether a map is wrong: its text, its numbers, or a name in it.
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

impl From<crate::problem::ProblemError> for RetargetError {
    fn from(error: crate::problem::ProblemError) -> Self {
        Self::Motion(error.into())
    }
}
