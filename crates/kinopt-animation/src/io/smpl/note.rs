//! Notes on SMPL motions.

use std::fmt;

/// Note on a motion, for review.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum SmplNote {
    /// The rest joints are those of the default skeleton.
    DefaultSkeleton {
        /// Height of the person, metres.
        height: f64,
    },
    /// The body model has fewer shape components than the motion.
    UnusedBetas {
        /// Number of components in use.
        used: usize,
        /// Number of components of the motion.
        given: usize,
    },
}

impl fmt::Display for SmplNote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::DefaultSkeleton { height } => write!(
                f,
                "no rest joints: a default skeleton of {height} m is used; give a body model or a height"
            ),
            Self::UnusedBetas { used, given } => {
                write!(f, "the first {used} of {given} shape components are used")
            }
        }
    }
}
