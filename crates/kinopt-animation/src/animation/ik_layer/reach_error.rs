//! Errors of IK layers.

use super::NoEffector;
use crate::animation::SizeMismatch;
use kinopt_kinematics::model::ModelError;
use kinopt_solver::ik::SolveError;

/// Error of an IK layer or of angles; the pose does not change.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReachError {
    /// The pose is of another armature than the skeleton's.
    #[error(transparent)]
    Size(#[from] SizeMismatch),
    /// A bone for which the layer has no task of this kind.
    #[error(transparent)]
    NoEffector(#[from] NoEffector),
    /// A target or rotation that is zero or not finite.
    #[error("bone `{bone}`: its {what}")]
    NotFinite {
        /// Name of the bone.
        bone: String,
        /// The value and its defect.
        what: &'static str,
    },
    /// Angles or a configuration of another length or not finite.
    #[error(transparent)]
    Configuration(#[from] ModelError),
    /// The solve did not start.
    #[error(transparent)]
    Solve(#[from] SolveError),
}
