//! Input that no solve can start from.

use thiserror::Error;

use crate::bad_option::BadOption;

/// Why a solve did not start. Missing a target is not an error but a [`Solution`](super::Solution).
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SolveError {
    /// An option out of its range.
    #[error(transparent)]
    Option(#[from] BadOption),
    /// A start of the wrong length.
    #[error("the start has {given} numbers, a configuration of `{model}` has {expected}")]
    StartLength {
        /// The model.
        model: String,
        /// Numbers given.
        given: usize,
        /// The model's degrees of freedom.
        expected: usize,
    },
    /// A start whose quaternion for a ball joint is zero.
    #[error("the start holds a quaternion without length for joint `{joint}`")]
    StartNoRotation {
        /// The joint.
        joint: String,
    },
    /// A start that is NaN or infinite. Outside the limits is fine.
    #[error("the start holds {value} for joint `{joint}`, which is not a finite number")]
    StartNotFinite {
        /// The joint.
        joint: String,
        /// The value.
        value: f64,
    },
    /// Joints of another model.
    #[error(
        "a model whose configuration has {given} numbers is not `{model}`, whose configuration has {expected}"
    )]
    OtherModel {
        /// The model that is solved.
        model: String,
        /// The numbers of its configuration.
        expected: usize,
        /// Numbers given.
        given: usize,
    },
    /// Joints cannot move on their parents where collisions are avoided.
    #[error("`{model}` avoids collisions, so its joints stay where they are on their parents")]
    JointsOfCollisions {
        /// The model.
        model: String,
    },
    /// Another number of moves than a configuration has numbers.
    #[error("{given} moves are given, a configuration of `{model}` has {expected} numbers")]
    MovesLength {
        /// The model.
        model: String,
        /// Moves given.
        given: usize,
        /// The numbers of a configuration.
        expected: usize,
    },
    /// Several moves for one ball joint, which turns by one angle.
    #[error("the four moves of ball joint `{joint}` are not the same")]
    MovesOfBall {
        /// The joint.
        joint: String,
    },
    /// Another number of limits than a configuration has numbers.
    #[error("{option} has {given} numbers, a configuration of `{model}` has {expected}")]
    MotionLimitsLength {
        /// The option.
        option: &'static str,
        /// The model.
        model: String,
        /// Numbers given.
        given: usize,
        /// The numbers of a configuration.
        expected: usize,
    },
    /// A problem whose motion cannot be limited by a time step.
    #[error("time_step: a drag with {reason} cannot keep limits of acceleration")]
    UnsupportedTimeStep {
        /// What the drag has.
        reason: String,
    },
    /// Moves of a problem with other variables.
    #[error("moves of a problem of {given} variables; that on `{model}` has {expected}")]
    ForeignMoves {
        /// The model.
        model: String,
        /// The variables of the moves.
        given: usize,
        /// The variables of the problem.
        expected: usize,
    },
}
