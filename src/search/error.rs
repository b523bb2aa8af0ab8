//! Errors of the input of a solve.

use thiserror::Error;

use crate::bad_option::BadOption;

/// Error of a solve that did not start. An unreached target is no error but a [`Solution`](super::Solution).
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SolveError {
    /// An option is out of its range.
    #[error(transparent)]
    Option(#[from] BadOption),
    /// The start has a wrong length.
    #[error("the start has {given} numbers, a configuration of `{model}` has {expected}")]
    StartLength {
        /// Name of the model.
        model: String,
        /// Length of the given start.
        given: usize,
        /// Length of a configuration of the model.
        expected: usize,
    },
    /// The start has a zero quaternion for a ball joint.
    #[error("the start holds a quaternion without length for joint `{joint}`")]
    StartNoRotation {
        /// Name of the joint.
        joint: String,
    },
    /// The start is NaN or infinite. A start outside the limits is allowed.
    #[error("the start holds {value} for joint `{joint}`, which is not a finite number")]
    StartNotFinite {
        /// Name of the joint.
        joint: String,
        /// Value of the coordinate.
        value: f64,
    },
    /// The number of moves differs from the length of a configuration.
    #[error("{given} moves are given, a configuration of `{model}` has {expected} numbers")]
    MovesLength {
        /// Name of the model.
        model: String,
        /// Number of given moves.
        given: usize,
        /// Length of a configuration of the model.
        expected: usize,
    },
    /// The four moves of a ball joint differ; it has one rotation angle.
    #[error("the four moves of ball joint `{joint}` are not the same")]
    MovesOfBall {
        /// Name of the joint.
        joint: String,
    },
    /// The number of motion limits differs from the length of a configuration.
    #[error("{option} has {given} numbers, a configuration of `{model}` has {expected}")]
    MotionLimitsLength {
        /// Name of the option.
        option: &'static str,
        /// Name of the model.
        model: String,
        /// Number of given limits.
        given: usize,
        /// Length of a configuration of the model.
        expected: usize,
    },
    /// The motion of the problem cannot be limited by a time step.
    #[error("time_step: a drag with {reason} cannot keep limits of acceleration")]
    UnsupportedTimeStep {
        /// The unsupported property of the drag.
        reason: String,
    },
    /// The moves belong to a problem with other variables.
    #[error("moves of a problem of {given} variables; that on `{model}` has {expected}")]
    ForeignMoves {
        /// Name of the model.
        model: String,
        /// Number of variables of the moves.
        given: usize,
        /// Number of variables of the problem.
        expected: usize,
    },
}
