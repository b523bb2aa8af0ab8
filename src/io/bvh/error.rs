//! What cannot be said in a BVH file.

use crate::animation::SizeMismatch;
use crate::io::WriteError;

/// Why motion cannot be written as BVH. Frames are counted from 0.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BvhError {
    /// An armature without bones.
    #[error("the armature has no bones, but a BVH file has a root at least")]
    NoBones,
    /// A name that would be read back as another one.
    #[error(
        "bone `{bone}`: a name in a BVH file has no braces and no white space but single spaces \
         between words"
    )]
    Name {
        /// The bone.
        bone: String,
    },
    /// A scale: the format has none.
    #[error("bone `{bone}` is scaled {}, which a BVH file cannot say", at(.frame))]
    Scaled {
        /// The bone.
        bone: String,
        /// In which frame; `None` at rest.
        frame: Option<usize>,
    },
    /// A place that is not finite or too far off to be read back.
    #[error("bone `{bone}` is too far from its parent or not finite {}", at(.frame))]
    OutOfRange {
        /// The bone.
        bone: String,
        /// In which frame; `None` at rest.
        frame: Option<usize>,
    },
    /// Channels that a reader rejects.
    #[error(
        "bone `{bone}` has {fault}; a joint has each position at most once and at most three rotations"
    )]
    Channels {
        /// The bone.
        bone: String,
        /// The first fault.
        fault: String,
    },
    /// A rate that is none.
    #[error("{rate} frames a second: the rate must be more than 0, and finite")]
    Rate {
        /// In frames a second.
        rate: f64,
    },
    /// More frames than times in single precision can tell apart.
    #[error("{duration} s at {rate} frames a second are more than {most} frames")]
    TooManyFrames {
        /// Of the clip, in seconds.
        duration: f64,
        /// In frames a second.
        rate: f64,
        /// The most there may be.
        most: usize,
    },
    /// The motion is of another armature.
    #[error(transparent)]
    Size(#[from] SizeMismatch),
    /// The file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

fn at(frame: &Option<usize>) -> String {
    frame.map_or_else(|| "at rest".to_owned(), |frame| format!("in frame {frame}"))
}
