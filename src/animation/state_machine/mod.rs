//! Animation state machines: data that can be loaded, checked once, and run by many characters.

mod definition;
mod error;
mod machine;
mod run;

pub use definition::{
    ConditionDefinition, Interruption, ParameterDefault, StateDefinition, StateMachineDefinition,
    TransitionDefinition, TriggerWord,
};
pub use error::{StateMachineError, StateMachineProblem};
pub use machine::StateMachine;
pub use run::{ParameterError, StateMachineRun};
