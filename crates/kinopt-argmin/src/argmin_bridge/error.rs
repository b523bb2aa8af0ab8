//! Errors of the bridge to argmin.

use std::sync::Arc;

use argmin::core::{ArgminError, Error};
use thiserror::Error as ThisError;

/// Error of a run without a solution.
#[derive(Clone, Debug, ThisError)]
#[non_exhaustive]
pub enum BridgeError {
    /// The run failed before it returned a state, for another reason than a start at the optimum.
    #[error("argmin: {0:#}")]
    Argmin(Arc<Error>),
    /// The state has no parameter vector.
    #[error("the argmin state holds no parameter vector: the solver was never initialised")]
    NoParameters,
    /// The state belongs to another problem.
    #[error("the argmin run has {given} variables, the problem has {expected}")]
    Variables {
        /// Number of variables of the run.
        given: usize,
        /// Number of variables of the problem.
        expected: usize,
    },
}

impl BridgeError {
    pub(super) fn check_variables(given: usize, expected: usize) -> Result<(), Self> {
        match given == expected {
            true => Ok(()),
            false => Err(Self::Variables { given, expected }),
        }
    }
}

/// Returns argmin's error for a parameter vector of the wrong length.
pub(super) fn check_length(given: usize, expected: usize) -> Result<(), Error> {
    if given == expected {
        return Ok(());
    }
    Err(ArgminError::InvalidParameter {
        text: format!("the parameter vector has {given} numbers, the problem {expected} variables"),
    }
    .into())
}
