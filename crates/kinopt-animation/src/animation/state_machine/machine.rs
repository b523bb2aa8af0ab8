//! State machines with resolved names.

use std::sync::Arc;

use super::condition::Transition;
use super::definition::{ParameterDefault, StateMachineDefinition};
use super::lookup::{Checked, MachineNames, error_at, finite};
use super::motion::ParameterBlend;
use crate::animation::{Clip, LayerError, Playback};

/// Checked states, transitions and clips. Immutable; each character that runs it has a
/// [`StateMachineRun`](super::StateMachineRun).
#[derive(Clone, Debug)]
pub struct StateMachine {
    pub(super) parameters: Vec<(String, ParameterDefault)>,
    pub(super) initial: usize,
    pub(super) states: Vec<State>,
    pub(super) transitions: Vec<Transition>,
}

#[derive(Clone, Debug)]
pub(super) struct State {
    pub(super) name: String,
    pub(super) motion: ParameterBlend,
    pub(super) playback: Playback,
    pub(super) speed: f64,
}

impl StateMachine {
    /// Checks a definition against the clips it names.
    ///
    /// # Errors
    /// A [`StateMachineError`](super::StateMachineError) with the path of the error:
    /// - a name does not exist (the error lists the valid names), or several clips have it;
    /// - a duration or number is out of range;
    /// - a condition does not match the kind of its parameter;
    /// - the clips are of different armatures.
    pub fn new(definition: &StateMachineDefinition, clips: &[Arc<Clip>]) -> Checked<Self> {
        let mut parameters = Vec::new();
        for (name, default) in &definition.parameters {
            if let ParameterDefault::Number(value) = default {
                finite(|| format!("parameters.{name}"), f64::from(*value))?;
            }
            parameters.push((name.clone(), *default));
        }
        let mut states: Vec<State> = Vec::new();
        let mut bones = None;
        for (index, state) in definition.states.iter().enumerate() {
            let path = format!("states[{index}]");
            if states.iter().any(|other| other.name == state.name) {
                let name = state.name.clone();
                let problem = LayerError::DuplicateState { name };
                return Err(error_at(format!("{path}.name"), problem));
            }
            let motion = ParameterBlend::new(&path, &state.motion, clips, &parameters, &mut bones)?;
            finite(|| format!("{path}.speed"), state.speed)?;
            states.push(State {
                name: state.name.clone(),
                motion,
                playback: state.playback,
                speed: state.speed,
            });
        }
        if states.is_empty() {
            return Err(error_at("states", LayerError::NoStates));
        }
        let names = MachineNames {
            parameters: &parameters,
            states: states.iter().map(|state| state.name.as_str()).collect(),
        };
        let initial = names.state(|| "initial".to_owned(), &definition.initial)?;
        let transitions = definition.transitions.iter().enumerate();
        let transitions = transitions
            .map(|(index, given)| Transition::new(&format!("transitions[{index}]"), given, &names));
        Ok(Self {
            transitions: transitions.collect::<Checked<_>>()?,
            initial,
            parameters,
            states,
        })
    }

    /// Names of the states.
    pub fn states(&self) -> impl Iterator<Item = &str> {
        self.states.iter().map(|state| state.name.as_str())
    }
}
