//! Errors of a collision checker.

use kinopt_kinematics::bad_option::BadOption;
use kinopt_kinematics::model::UnknownName;

/// Reason why a checker of a robot and a world cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CheckerError {
    /// An obstacle attached to a frame that the robot does not have.
    #[error("obstacle `{obstacle}`: it cannot be attached to the robot: {unknown}")]
    Attached {
        /// Name of the obstacle.
        obstacle: String,
        /// Name of the frame, and the valid names.
        unknown: UnknownName,
    },
    /// An obstacle that may collide with an unknown link or obstacle.
    #[error("obstacle `{obstacle}`: invalid allowed collision: {unknown}")]
    MayTouch {
        /// Name of the obstacle.
        obstacle: String,
        /// Unknown name, and the valid names.
        unknown: UnknownName,
    },
    /// An option out of its range.
    #[error(transparent)]
    Option(#[from] BadOption),
}
