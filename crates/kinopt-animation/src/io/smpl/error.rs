//! Errors of SMPL motions.

use crate::animation::ClipError;

/// Reason why arrays are not a motion of the SMPL family.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SmplError {
    /// The rotations are not those of a known number of joints.
    #[error(
        "poses have {numbers} numbers a frame, expected 72 (SMPL), 156 (SMPL-H) or 165 (SMPL-X)"
    )]
    OtherJoints {
        /// Numbers of a frame.
        numbers: usize,
    },
    /// There are no frames.
    #[error("the motion has no frames: at least one is needed")]
    NoFrames,
    /// Another count of numbers is needed.
    #[error("`{array}` has {given} numbers, expected {expected}")]
    OtherLength {
        /// Name of the array.
        array: &'static str,
        /// Count of given numbers.
        given: usize,
        /// Expected count.
        expected: usize,
    },
    /// The body model is of another family.
    #[error(
        "the body model has {given} joints, but the motion is of {family} with {expected} joints"
    )]
    OtherBodyModel {
        /// Joints of the body model.
        given: usize,
        /// Joints of the motion.
        expected: usize,
        /// Family of the motion.
        family: &'static str,
    },
    /// A number is not finite.
    #[error("`{array}` has a number that is not finite, at index {index}")]
    NotFinite {
        /// Name of the array.
        array: &'static str,
        /// Index of the number.
        index: usize,
    },
    /// The frame rate is not positive.
    #[error("the frame rate is {0}, expected a positive number")]
    BadFrameRate(f64),
    /// The height is not positive.
    #[error("the height is {0} m, expected a number from 0.1 to 10")]
    BadHeight(f64),
    /// The rest joints or the frames do not form a valid clip.
    #[error(transparent)]
    Clip(#[from] ClipError),
}
