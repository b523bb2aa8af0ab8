//! Errors of trajectory optimisation.

use super::rate_cost::RateCostError;
use kinopt_kinematics::bad_option::BadOption;
use kinopt_kinematics::model::{ModelError, UnknownName};
use kinopt_solver::ik::SolveError;
use kinopt_solver::problem::ProblemError;

/// Reason why a trajectory cannot be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MotionError {
    /// A task is invalid.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// A number is out of its range.
    #[error(transparent)]
    Option(#[from] BadOption),
    /// The model does not have the name.
    #[error(transparent)]
    Name(#[from] UnknownName),
    /// A configuration is not valid for the model.
    #[error(transparent)]
    Configuration(#[from] ModelError),
    /// The start configuration or the initial trajectory is invalid.
    #[error(transparent)]
    Start(#[from] SolveError),
    /// The caller's flag cancelled the search.
    #[error("the search was cancelled")]
    Cancelled,
    /// The trajectory has no samples.
    #[error("the trajectory has no frames: at least one is needed")]
    NoFrames,
    /// A list has the wrong length.
    #[error("{what}: {given} numbers instead of {expected}")]
    Length {
        /// Name of the list.
        what: String,
        /// Given length.
        given: usize,
        /// Expected length.
        expected: usize,
    },
    /// A weight of a sample is negative or not finite.
    #[error(
        "task {task}: its weight {weight} in frame {frame} is not a finite number of at least 0"
    )]
    BadWeight {
        /// Name of the task.
        task: String,
        /// Index of the sample.
        frame: usize,
        /// Given weight.
        weight: f64,
    },
    /// A required task has a lower level than others.
    #[error(
        "task {task} is at level {level}: trajectories have no levels, so weight the task by `scale`"
    )]
    Level {
        /// Name of the task.
        task: String,
        /// Level of the task.
        level: usize,
    },
    /// A ball joint has a velocity limit, which the online retargeter does not support.
    #[error(
        "ball joint `{joint}` has a velocity limit: online retargeting needs a robot file without it"
    )]
    SpeedOfBall {
        /// Name of the joint.
        joint: String,
    },
    /// A contact spans fewer than two samples, or samples that do not exist.
    #[error(
        "contact over the frames {start} to {end}, end excluded: at least two of the {frames} frames are needed"
    )]
    BadSpan {
        /// First sample of the span.
        start: usize,
        /// One after the last sample of the span.
        end: usize,
        /// Number of samples.
        frames: usize,
    },
    /// A fixed sample is beyond a limit.
    #[error("joint `{joint}`: value {value} of the fixed frame is outside [{lower}, {upper}]")]
    FixedBeyond {
        /// Name of the joint.
        joint: String,
        /// Value of the joint.
        value: f64,
        /// Lower limit.
        lower: f64,
        /// Upper limit.
        upper: f64,
    },
    /// A joint cannot get from one fixed sample to the next within its velocity limit.
    #[error(
        "joint `{joint}` cannot move from one fixed frame to the next within its velocity limit"
    )]
    TooFar {
        /// Name of the joint.
        joint: String,
    },
    /// A residual or its derivative is not finite.
    #[error("frame {frame}: a residual or its derivative is not finite")]
    NotFinite {
        /// Index of the sample.
        frame: usize,
    },
}

impl From<RateCostError> for MotionError {
    fn from(error: RateCostError) -> Self {
        match error {
            RateCostError::Option(bad) => bad.into(),
            RateCostError::Name(unknown) => unknown.into(),
        }
    }
}
