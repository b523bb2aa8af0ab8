//! Errors of state machine definitions.

use crate::animation::LayerError;

/// Location in the definition and error there.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{path}: {problem}")]
#[non_exhaustive]
pub struct StateMachineError {
    /// Path such as `transitions[2].to`.
    pub path: String,
    /// The error at that path.
    #[source]
    pub problem: LayerError,
}
