//! Errors of geometric methods.

use thiserror::Error;

use crate::ik::SolveError;

/// The reason why a geometric solve did not start.
///
/// An unreached target is not an error: see [`Solution::reached`](crate::Solution::reached).
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum GeometricError {
    /// A start of wrong length or with a number that is not finite, or an option out of its range.
    #[error(transparent)]
    Start(#[from] SolveError),
    /// A task that the method does not support.
    #[error("{solver} does not support task {task}; supported tasks: {valid}")]
    UnsupportedTask {
        /// The name of the method.
        solver: &'static str,
        /// The name of the task.
        task: String,
        /// The supported kinds of tasks.
        valid: &'static str,
    },
    /// A ball joint: these methods move joints with one axis.
    #[error("joint `{joint}` is a ball joint, which {solver} does not support; use a `Solver`")]
    BallJoint {
        /// The name of the method.
        solver: &'static str,
        /// The name of the joint.
        joint: String,
    },
    /// A prismatic joint, for a method that needs fixed distances between joints.
    #[error("joint `{joint}` is prismatic, which {solver} does not support; use CCD")]
    SlidingJoint {
        /// The name of the method.
        solver: &'static str,
        /// The name of the joint, or of its source joint.
        joint: String,
    },
    /// A chain without exactly two bones.
    #[error(
        "model `{model}`: the free joints form {bones} bones with {tips} tip points, but the analytic \
         solution needs 2 bones with 1 tip point; lock other joints by a `ParameterMap`"
    )]
    NotTwoBones {
        /// The name of the model.
        model: String,
        /// Number of distances between points with free joints, including the tip's.
        bones: usize,
        /// Number of points with a target.
        tips: usize,
    },
}
