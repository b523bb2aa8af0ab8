//! Why a pose is left as it is.

use crate::animation::SizeMismatch;
use crate::ik::SolveError;

/// Why a layer leaves a pose as it is.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReachError {
    /// The pose is of another armature than the skeleton's.
    #[error(transparent)]
    Size(#[from] SizeMismatch),
    /// A bone's scale would shear what hangs on it as that turns.
    #[error(
        "bone `{bone}` scales what hangs on it by different numbers along its axes, mirrors it or \
         takes its size away, so it cannot be reached with"
    )]
    Sheared {
        /// The bone.
        bone: String,
    },
    /// The search did not start.
    #[error(transparent)]
    Solve(#[from] SolveError),
}
