//! A state machine whose names are resolved.

use std::sync::Arc;

use super::condition::Transition;
use super::definition::{ParameterDefault, StateMachineDefinition};
use super::error::StateMachineProblem;
use super::lookup::{Checked, at, find, finite};
use super::motion::Motion;
use crate::animation::{Clip, Playback};

/// States, transitions and the clips they play, checked. It never changes; each character that runs
/// it has a [`StateMachineRun`](super::StateMachineRun).
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
    pub(super) motion: Motion,
    pub(super) playback: Playback,
    pub(super) speed: f64,
}

impl StateMachine {
    /// Checks a definition against the clips it names.
    ///
    /// # Errors
    /// A [`StateMachineError`](super::StateMachineError) with the path of what is wrong: a name that
    /// does not exist (the error lists those that do) or that several clips have, a duration or number that is out of range, a
    /// condition that does not suit its parameter, or clips of different armatures.
    pub fn new(definition: &StateMachineDefinition, clips: &[Arc<Clip>]) -> Checked<Self> {
        let mut own = Self {
            parameters: Vec::new(),
            initial: 0,
            states: Vec::new(),
            transitions: Vec::new(),
        };
        for (name, default) in &definition.parameters {
            if let ParameterDefault::Number(value) = default {
                finite(|| format!("parameters.{name}"), f64::from(*value))?;
            }
            own.parameters.push((name.clone(), *default));
        }
        for (index, state) in definition.states.iter().enumerate() {
            let path = |key: &str| format!("states[{index}].{key}");
            if own.states.iter().any(|other| other.name == state.name) {
                let name = state.name.clone();
                let problem = StateMachineProblem::DuplicateState { name };
                return Err(at(path("name"), problem));
            }
            let motion = own.motion(&format!("states[{index}]"), &state.motion, clips)?;
            finite(|| path("speed"), state.speed)?;
            own.states.push(State {
                name: state.name.clone(),
                motion,
                playback: state.playback,
                speed: state.speed,
            });
        }
        if own.states.is_empty() {
            return Err(at("states", StateMachineProblem::NoStates));
        }
        own.initial = own.state(|| "initial".to_owned(), &definition.initial)?;
        for (index, transition) in definition.transitions.iter().enumerate() {
            let transition = own.transition(&format!("transitions[{index}]"), transition)?;
            own.transitions.push(transition);
        }
        Ok(own)
    }

    pub(super) fn state(&self, path: impl FnOnce() -> String, name: &str) -> Checked<usize> {
        let states = self.states.iter().map(|state| state.name.as_str());
        find(path, "state", name, states)
    }

    /// The states' names.
    pub fn states(&self) -> impl Iterator<Item = &str> {
        self.states.iter().map(|state| state.name.as_str())
    }
}
