//! Errors of the input of a solve.

use thiserror::Error;

use kinopt_kinematics::bad_option::BadOption;

/// Error of a solve that did not start. An unreached target is no error but a [`Solution`](super::Solution).
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SolveError {
    /// An option is out of its range.
    #[error(transparent)]
    Option(#[from] BadOption),
    /// The start has a wrong length.
    #[error("the start has {given} numbers, expected {expected} for `{model}`")]
    StartLength {
        /// Name of the model.
        model: String,
        /// Length of the given start.
        given: usize,
        /// Length of a configuration of the model.
        expected: usize,
    },
    /// The start has a zero quaternion for a ball joint.
    #[error("the start: the quaternion of joint `{joint}` has length 0")]
    StartNoRotation {
        /// Name of the joint.
        joint: String,
    },
    /// The start is NaN or infinite. A start outside the limits is allowed.
    #[error("the start: joint `{joint}` is {value}, which is not a finite number")]
    StartNotFinite {
        /// Name of the joint.
        joint: String,
        /// Value of the coordinate.
        value: f64,
    },
    /// Joints of another model.
    #[error(
        "a configuration of the given model has {given} numbers, one of `{model}` has {expected}"
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
    #[error("`{model}`: joint origins are constant with collision avoidance")]
    JointsOfCollisions {
        /// The model.
        model: String,
    },
    /// Another number of moves than a configuration has numbers.
    #[error("{given} moves, expected {expected} for a configuration of `{model}`")]
    MovesLength {
        /// Name of the model.
        model: String,
        /// Number of given moves.
        given: usize,
        /// Length of a configuration of the model.
        expected: usize,
    },
    /// The four moves of a ball joint differ; it has one rotation angle.
    #[error("the four moves of ball joint `{joint}` differ")]
    MovesOfBall {
        /// Name of the joint.
        joint: String,
    },
    /// The number of motion limits differs from the length of a configuration.
    #[error("{option} has {given} numbers, expected {expected} for a configuration of `{model}`")]
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
    #[error("time_step: a drag with {reason} does not support acceleration limits")]
    UnsupportedTimeStep {
        /// The unsupported property of the drag.
        reason: String,
    },
    /// The moves belong to a problem with other variables.
    #[error("moves for {given} variables, expected {expected} for the problem on `{model}`")]
    ForeignMoves {
        /// Name of the model.
        model: String,
        /// Number of variables of the moves.
        given: usize,
        /// Number of variables of the problem.
        expected: usize,
    },
}
