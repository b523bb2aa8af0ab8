//! Animation state machines: data that can be loaded, checked once, and run by many characters.

mod condition;
mod definition;
mod error;
mod event;
mod lookup;
mod machine;
mod motion;
mod parameters;
mod playing;
mod run;
mod transitions;

pub use definition::{
    BlendClip, BlendDefinition, ConditionDefinition, Interruption, MotionDefinition,
    ParameterDefault, StateDefinition, StateMachineDefinition, TransitionDefinition, TriggerWord,
};
pub use error::StateMachineError;
pub use event::StateEvent;
pub use machine::StateMachine;
pub use parameters::ParameterValue;
pub use run::StateMachineRun;
