//! Errors of inverse kinematics over a clip.

use crate::motion::trajectory::MotionError;
use kinopt_animation::animation::ClipError;
use kinopt_kinematics::SizeMismatch;
use kinopt_kinematics::bad_option::BadOption;
use kinopt_kinematics::curve::KeyError;
use kinopt_kinematics::kinematics::KinematicsError;
use kinopt_kinematics::model::ModelError;
use kinopt_solver::ik::SolveError;
use kinopt_solver::problem::ProblemError;

/// Reason why a clip cannot be solved.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ClipIkError {
    /// There is no reach and no planted bone.
    #[error("nothing to solve: no reach and no planted bone")]
    Nothing,
    /// A bone is not in the armature.
    #[error("bone {bone} does not exist: the armature has {bones} bones")]
    UnknownBone {
        /// Index of the bone.
        bone: usize,
        /// Number of bones of the armature.
        bones: usize,
    },
    /// The armature was not built from the skeleton.
    #[error(
        "bone `{bone}` of the skeleton differs from the armature: build the armature from this skeleton"
    )]
    OtherSkeleton {
        /// First bone of the skeleton that differs from the armature.
        bone: String,
    },
    /// A bone with a target is not below the root.
    #[error("bone `{bone}` is not below the root `{root}`")]
    NotBelowRoot {
        /// Bone with the target.
        bone: String,
        /// Root bone.
        root: String,
    },
    /// The displacement per second is not finite, or there is no root to move.
    #[error(
        "root velocity {root_velocity:?} per second: must be finite, and needs a root that carries all requested bones"
    )]
    RootVelocity {
        /// Displacement per second.
        root_velocity: [f32; 3],
    },
    /// A bone has two tasks at one time.
    #[error("bone `{bone}`: two targets at the same time; only one is allowed")]
    Twice {
        /// Bone with two tasks.
        bone: String,
    },
    /// A span does not overlap the clip, or is shorter than its two fades.
    #[error(
        "span from {from} s to {to} s with fades of {fade} s: it must overlap the clip, {} s to {} s, and be no shorter than two fades",
        clip[0], clip[1]
    )]
    BadSpan {
        /// Start of the span, seconds.
        from: f64,
        /// End of the span, seconds.
        to: f64,
        /// Duration of each fade, seconds.
        fade: f64,
        /// First and last time of the clip, seconds.
        clip: [f64; 2],
    },
    /// The keys of a target curve are invalid.
    #[error("target curve: {0}")]
    Curve(#[from] KeyError),
    /// No key within the span may change.
    #[error("no key to change: no bone that carries a tip has a key within the span of its reach")]
    NoKeys,
    /// The new keys make no valid clip.
    #[error("new keys: {0}")]
    Keys(#[source] ClipError),
    /// An option is out of range.
    #[error(transparent)]
    Option(#[from] BadOption),
    /// The clip's channels are invalid, or the clip cannot be sampled at some time.
    #[error(transparent)]
    Clip(#[from] ClipError),
    /// The clip is of another armature.
    #[error(transparent)]
    Size(#[from] SizeMismatch),
    /// The bones make no valid model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The problem of a frame is invalid.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// A frame cannot be solved from its start configuration.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// The motion of the root cannot be solved.
    #[error("motion of the root: {0}")]
    Root(#[from] MotionError),
    /// A position is not finite.
    #[error(transparent)]
    Kinematics(#[from] KinematicsError),
}
