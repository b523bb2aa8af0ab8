//! Errors of scores.

use crate::motion::retarget::RetargetError;
use kinopt_kinematics::bad_option::BadOption;
use kinopt_kinematics::kinematics::KinematicsError;
use kinopt_kinematics::model::{ModelError, UnknownName};

/// Reason why a motion has no score.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ScoreError {
    /// The capture, the model or the weights do not have the name.
    #[error(transparent)]
    Name(#[from] UnknownName),
    /// A number is out of its range.
    #[error(transparent)]
    Option(#[from] BadOption),
    /// The map does not fit the capture or the model.
    #[error(transparent)]
    Map(#[from] RetargetError),
    /// A configuration is invalid.
    #[error(transparent)]
    Configuration(#[from] KinematicsError),
    /// A configuration does not fit the model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The numbers are not whole configurations.
    #[error(
        "the motion has {numbers} numbers, expected a multiple of {expected}, the length of a configuration of `{model}`, and at least one configuration"
    )]
    NotConfigurations {
        /// Count of given numbers.
        numbers: usize,
        /// Length of a configuration.
        expected: usize,
        /// Name of the model.
        model: String,
    },
    /// The start time is after the end of the capture.
    #[error("start is {start} s, but the capture ends at {end} s")]
    StartsAfterEnd {
        /// Given start, seconds.
        start: f64,
        /// Time of the last capture frame, seconds.
        end: f64,
    },
}
