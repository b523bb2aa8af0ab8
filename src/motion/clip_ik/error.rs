//! What can be wrong with inverse kinematics over a clip.

use crate::SizeMismatch;
use crate::animation::curve::KeyError;
use crate::animation::{ChannelError, ClipError, SampleError};
use crate::bad_option::BadOption;
use crate::ik::SolveError;
use crate::kinematics::KinematicsError;
use crate::model::ModelError;
use crate::motion::trajectory::MotionError;
use crate::problem::ProblemError;

/// Why nothing can be solved over a clip.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ClipIkError {
    /// Nothing is asked.
    #[error("nothing to reach and nothing to plant")]
    Nothing,
    /// A bone of another armature.
    #[error("bone {bone} does not exist; the armature has {bones}")]
    UnknownBone {
        /// The bone's index.
        bone: usize,
        /// How many bones there are.
        bones: usize,
    },
    /// A skeleton that the armature is not of.
    #[error("bone `{bone}` of the skeleton is not the armature's at its place")]
    OtherSkeleton {
        /// The skeleton's bone.
        bone: String,
    },
    /// A bone that cannot be led as the root does not carry it.
    #[error("bone `{bone}` does not hang on the root `{root}`")]
    NotBelowRoot {
        /// The bone.
        bone: String,
        /// The root.
        root: String,
    },
    /// A way that is not finite, or no root to travel.
    #[error(
        "root velocity {root_velocity:?} a second: it must be finite, and there must be a root that carries all bones asked for"
    )]
    RootVelocity {
        /// What was asked for.
        root_velocity: [f32; 3],
    },
    /// Two things are asked of a bone at one time.
    #[error("bone `{bone}` is asked for twice at the same time")]
    Twice {
        /// The bone.
        bone: String,
    },
    /// A span that is not within the clip, or that fades longer than it lasts.
    #[error(
        "the span from {from} s to {to} s with fades of {fade} s: it must be within the clip's {} s to {} s, and its fades within it",
        clip[0], clip[1]
    )]
    BadSpan {
        /// In seconds.
        from: f64,
        /// In seconds.
        to: f64,
        /// In seconds.
        fade: f64,
        /// From when to when the clip lasts, in seconds.
        clip: [f64; 2],
    },
    /// The keys of a curve of targets.
    #[error("the curve of targets: {0}")]
    Curve(#[from] KeyError),
    /// No key that may change.
    #[error("no key of a bone that carries what reaches lies within its span")]
    NoKeys,
    /// Keys that make no clip.
    #[error("the new keys: {0}")]
    Keys(#[from] ClipError),
    /// A moment at which the keys cannot be sampled.
    #[error(transparent)]
    Sample(#[from] SampleError),
    /// A number out of its range.
    #[error(transparent)]
    Option(#[from] BadOption),
    /// What the clip's channels refuse.
    #[error(transparent)]
    Channel(#[from] ChannelError),
    /// A clip of another armature.
    #[error(transparent)]
    Size(#[from] SizeMismatch),
    /// Bones that make no model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// What the problem of a frame refuses.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// A frame that cannot be started from.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// The root's way.
    #[error("the way of the root: {0}")]
    Root(#[from] MotionError),
    /// A place that is not finite.
    #[error(transparent)]
    Kinematics(#[from] KinematicsError),
}
