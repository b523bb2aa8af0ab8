//! What can be wrong with a checker.

use crate::bad_option::BadOption;
use crate::model::UnknownName;

/// Why a robot and a world do not go together.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CheckerError {
    /// An obstacle attached to a frame that the robot does not have.
    #[error("obstacle `{obstacle}` is attached to what the robot does not have: {unknown}")]
    Attached {
        /// The obstacle.
        obstacle: String,
        /// The frame, and the valid names.
        unknown: UnknownName,
    },
    /// An obstacle that may touch what neither the robot nor the world has.
    #[error("obstacle `{obstacle}` may touch what is not there: {unknown}")]
    MayTouch {
        /// The obstacle.
        obstacle: String,
        /// What it may touch, and the valid names.
        unknown: UnknownName,
    },
    /// An option out of its range.
    #[error(transparent)]
    Option(#[from] BadOption),
}
