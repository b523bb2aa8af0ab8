//! Why a pose is left as it is.

use super::NoEffector;
use crate::animation::SizeMismatch;
use crate::ik::SolveError;
use crate::model::ModelError;

/// Why a layer, or angles, leave a pose as it is.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReachError {
    /// The pose is of another armature than the skeleton's.
    #[error(transparent)]
    Size(#[from] SizeMismatch),
    /// A bone that the layer has no such task for.
    #[error(transparent)]
    NoEffector(#[from] NoEffector),
    /// A target, or a rotation, that is none.
    #[error("bone `{bone}`: its {what}")]
    NotFinite {
        /// The bone.
        bone: String,
        /// What of it, and how it is wrong.
        what: &'static str,
    },
    /// Angles, or a configuration, of another length or not finite.
    #[error(transparent)]
    Configuration(#[from] ModelError),
    /// The search did not start.
    #[error(transparent)]
    Solve(#[from] SolveError),
}
