//! Problems that geometry has no answer for.

use thiserror::Error;

use crate::ik::SolveError;

/// Why a geometric solve did not start. Missing a target is no error: see
/// [`Solution::reached`](crate::Solution::reached).
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum GeometricError {
    /// A start of the wrong length or with a number that is not finite, or an option out of its range.
    #[error(transparent)]
    Start(#[from] SolveError),
    /// A task that the method does not understand.
    #[error("{solver} has no answer for task {task}; it takes tasks of kind {valid}")]
    UnsupportedTask {
        /// The method.
        solver: &'static str,
        /// The task.
        task: String,
        /// What the method takes.
        valid: &'static str,
    },
    /// A ball joint: these methods turn joints of one axis.
    #[error(
        "joint `{joint}` is a ball; {solver} turns joints about one axis each (a `Solver` any)"
    )]
    BallJoint {
        /// The method.
        solver: &'static str,
        /// The joint.
        joint: String,
    },
    /// A sliding joint, for a method that keeps the distances between joints.
    #[error("joint `{joint}` slides; {solver} needs fixed distances between joints (CCD does not)")]
    SlidingJoint {
        /// The method.
        solver: &'static str,
        /// The joint, or the one that it follows.
        joint: String,
    },
    /// A chain that is not two bones.
    #[error(
        "model `{model}`: the free joints make {bones} bones with {tips} tip points, the analytic \
         solution is for 2 bones with 1; lock the other joints with a ParameterMap"
    )]
    NotTwoBones {
        /// The model.
        model: String,
        /// How many distances between points where free joints are, the tip's included.
        bones: usize,
        /// How many points have a place to go to.
        tips: usize,
    },
}
