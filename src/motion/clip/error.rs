//! What can be wrong with a motion that is asked for.

use super::rate_cost::RateCostError;
use crate::bad_option::BadOption;
use crate::ik::SolveError;
use crate::model::{ModelError, UnknownName};
use crate::problem::ProblemError;
use crate::solver::SearchError;

/// Why a motion cannot be solved for.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MotionError {
    /// What the tasks of a frame are told wrong.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// A number out of its range.
    #[error(transparent)]
    Option(#[from] BadOption),
    /// A name that the model does not have.
    #[error(transparent)]
    Name(#[from] UnknownName),
    /// A configuration that is none of the model's.
    #[error(transparent)]
    Configuration(#[from] ModelError),
    /// A first motion that no search begins.
    #[error(transparent)]
    Search(#[from] SearchError),
    /// A start that the frames cannot be solved from.
    #[error(transparent)]
    Start(#[from] SolveError),
    /// The caller's flag ended the search.
    #[error("the search was cancelled")]
    Cancelled,
    /// No frame.
    #[error("a motion of no frames")]
    NoFrames,
    /// Numbers for another count of frames.
    #[error("{what}: {given} numbers instead of {expected}")]
    Length {
        /// What the numbers are.
        what: String,
        /// How many are given.
        given: usize,
        /// How many there must be.
        expected: usize,
    },
    /// A weight of a frame that is negative or not finite.
    #[error(
        "task {task}: its weight {weight} in frame {frame} is not a finite number of at least 0"
    )]
    BadWeight {
        /// The task.
        task: String,
        /// The frame.
        frame: usize,
        /// The weight.
        weight: f64,
    },
    /// A goal below others.
    #[error(
        "task {task} is at level {level}: whole motions weigh all tasks together, so leave levels out and weigh it by `times`"
    )]
    Level {
        /// The task.
        task: String,
        /// Its level.
        level: usize,
    },
    /// A speed limit of a ball, where movements are followed frame by frame.
    #[error(
        "joint `{joint}` turns as a ball, whose speed limit a follower does not keep: leave it out of the robot's file"
    )]
    SpeedOfBall {
        /// The joint.
        joint: String,
    },
    /// A contact over frames that there are not, or over less than two.
    #[error(
        "a contact over the frames {start} to {end}, end excluded: it needs two of the motion's {frames} frames"
    )]
    BadSpan {
        /// The first frame.
        start: usize,
        /// The one after the last.
        end: usize,
        /// How many frames there are.
        frames: usize,
    },
    /// A fixed frame beyond a limit.
    #[error(
        "joint `{joint}`: the fixed frame has it at {value}, beyond its limits [{lower}, {upper}]"
    )]
    FixedBeyond {
        /// The joint.
        joint: String,
        /// Its value there.
        value: f64,
        /// Its lower limit.
        lower: f64,
        /// Its upper limit.
        upper: f64,
    },
    /// Fixed frames that a joint is too slow for.
    #[error(
        "joint `{joint}` cannot come from one fixed frame to the next as slowly as its speed limit wants"
    )]
    TooFar {
        /// The joint.
        joint: String,
    },
    /// A residual that is not finite.
    #[error("frame {frame}: a residual or its derivative is not finite")]
    NotFinite {
        /// The frame.
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
