//! Animation state machines: data that can be loaded, checked once, and run by many characters.

mod definition;
mod error;
mod event;
mod machine;
mod parameters;
mod playing;
mod run;
mod transitions;

pub use definition::{
    ConditionDefinition, Interruption, ParameterDefault, StateDefinition, StateMachineDefinition,
    TransitionDefinition, TriggerWord,
};
pub use error::{StateMachineError, StateMachineProblem};
pub use event::StateEvent;
pub use machine::StateMachine;
pub use parameters::ParameterError;
pub use run::StateMachineRun;
