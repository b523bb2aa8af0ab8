//! What can go wrong between argmin and us.

use std::sync::Arc;

use argmin::core::{ArgminError, Error};
use thiserror::Error as ThisError;

/// Why a run has no solution to report.
#[derive(Clone, Debug, ThisError)]
#[non_exhaustive]
pub enum BridgeError {
    /// The run failed before it returned a state, and not for want of anything to improve.
    #[error("argmin: {0:#}")]
    Argmin(Arc<Error>),
    /// The state holds no parameter vector.
    #[error("the argmin state holds no parameter vector: the solver was never initialised")]
    NoParameters,
    /// The state is of another problem.
    #[error("the argmin run has {given} variables, the problem has {expected}")]
    Variables {
        /// Variables of the run.
        given: usize,
        /// Variables of the problem.
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

/// What an evaluation answers to a parameter vector of the wrong length.
pub(super) fn check_length(given: usize, expected: usize) -> Result<(), Error> {
    if given == expected {
        return Ok(());
    }
    Err(ArgminError::InvalidParameter {
        text: format!("the parameter vector has {given} numbers, the problem {expected} variables"),
    }
    .into())
}
