//! What can go wrong before solvers are compared.

use std::path::PathBuf;

use kinopt::kinematics::KinematicsError;
use kinopt::model::ModelError;
use kinopt::problem::ProblemError;
use kinopt_charts::ChartError;

/// Why a bench or its report cannot be made. A solver that fails is no error: it has not solved.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum HarnessError {
    /// There is nothing to ask.
    #[error("the problem set on model `{model}` has no cases")]
    NoCases {
        /// The model.
        model: String,
    },
    /// A case of the wrong shape.
    #[error("case {case} has {given} {what}, model `{model}` takes {expected}")]
    CaseShape {
        /// Its position.
        case: usize,
        /// "targets" or "numbers in its start".
        what: &'static str,
        /// How many were given.
        given: usize,
        /// How many it takes.
        expected: usize,
        /// The model.
        model: String,
    },
    /// A tolerance that nothing or everything meets.
    #[error("the tolerance {tolerance} is not within (0, 0.1]")]
    Tolerance {
        /// What was given.
        tolerance: f64,
    },
    /// The problem cannot be stated.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// A frame of another model.
    #[error(transparent)]
    Kinematics(#[from] KinematicsError),
    /// Joints that follow in a ring and the like.
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
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
}
