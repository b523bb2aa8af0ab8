//! Errors of benches and reports.

use std::path::PathBuf;

use kinopt::kinematics::KinematicsError;
use kinopt::model::ModelError;
use kinopt::problem::ProblemError;
use kinopt_charts::ChartError;

/// Reason why a bench or its report cannot be created. A solver that fails is no error: its problem counts as not
/// solved.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum HarnessError {
    /// A problem set without cases.
    #[error("the problem set on model `{model}` has no cases")]
    NoCases {
        /// Name of the model.
        model: String,
    },
    /// A case of the wrong shape.
    #[error("case {case} has {given} {what}, model `{model}` takes {expected}")]
    CaseShape {
        /// Index of the case.
        case: usize,
        /// "targets" or "numbers in its start".
        what: &'static str,
        /// Given number.
        given: usize,
        /// Expected number.
        expected: usize,
        /// Name of the model.
        model: String,
    },
    /// A tolerance out of range.
    #[error("the tolerance {tolerance} is not within (0, 0.1]")]
    Tolerance {
        /// Given tolerance.
        tolerance: f64,
    },
    /// An invalid problem.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// A frame of another model.
    #[error(transparent)]
    Kinematics(#[from] KinematicsError),
    /// An invalid model, for example with a cycle of mimic joints.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A picture that cannot be drawn.
    #[error(transparent)]
    Chart(#[from] ChartError),
    /// The results cannot be written as JSON.
    #[error("the results cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// A file that cannot be written.
    #[error("{}: cannot be written: {source}", path.display())]
    Write {
        /// Path of the file.
        path: PathBuf,
        /// Cause.
        source: std::io::Error,
    },
}
