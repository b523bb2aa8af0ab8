//! A state machine whose names are resolved.

use std::sync::Arc;

use super::definition::{
    ConditionDefinition, Interruption, ParameterDefault, StateMachineDefinition,
    TransitionDefinition,
};
use super::error::{StateMachineError, StateMachineProblem};
use crate::animation::{Clip, Easing, Playback};
use crate::model::UnknownName;

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
    pub(super) clip: Arc<Clip>,
    pub(super) playback: Playback,
    pub(super) speed: f64,
}

#[derive(Clone, Debug)]
pub(super) struct Transition {
    pub(super) from: Option<usize>,
    pub(super) to: usize,
    pub(super) seconds: f64,
    pub(super) easing: Easing,
    pub(super) after: Option<f64>,
    pub(super) after_seconds: Option<f64>,
    pub(super) conditions: Vec<Condition>,
    pub(super) interruption: Interruption,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Condition {
    Between {
        parameter: usize,
        above: f32,
        below: f32,
    },
    Is {
        parameter: usize,
        value: bool,
    },
    Triggered {
        parameter: usize,
    },
}

type Checked<T> = Result<T, StateMachineError>;

fn at(path: impl Into<String>, problem: StateMachineProblem) -> StateMachineError {
    StateMachineError {
        path: path.into(),
        problem,
    }
}

fn finite(path: impl FnOnce() -> String, value: f64) -> Checked<()> {
    if value.is_finite() {
        return Ok(());
    }
    Err(at(path(), StateMachineProblem::NotFinite { value }))
}

/// The position of a name.
fn find<'a>(
    path: impl FnOnce() -> String,
    kind: &'static str,
    name: &str,
    mut valid: impl Iterator<Item = &'a str> + Clone,
) -> Checked<usize> {
    let names = valid.clone();
    valid.position(|own| own == name).ok_or_else(|| {
        let unknown = UnknownName::new(kind, name, names);
        at(path(), StateMachineProblem::Unknown(unknown))
    })
}

impl StateMachine {
    /// Checks a definition against the clips it names.
    ///
    /// # Errors
    /// A [`StateMachineError`] with the path of what is wrong: a name that does not exist (the error
    /// lists those that do), a duration or number that is out of range, a condition that does not
    /// suit its parameter, or clips of different armatures.
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
            let names = clips.iter().map(|clip| clip.name());
            let clip = find(|| path("clip"), "clip", &state.clip, names)?;
            let clip = Arc::clone(&clips[clip]);
            let expected = own.states.first().map_or(clip.bones(), |s| s.clip.bones());
            if clip.bones() != expected {
                let problem = StateMachineProblem::OtherArmature {
                    clip: state.clip.clone(),
                    bones: clip.bones(),
                    expected,
                };
                return Err(at(path("clip"), problem));
            }
            finite(|| path("speed"), state.speed)?;
            own.states.push(State {
                name: state.name.clone(),
                clip,
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

    fn state(&self, path: impl FnOnce() -> String, name: &str) -> Checked<usize> {
        let states = self.states.iter().map(|state| state.name.as_str());
        find(path, "state", name, states)
    }

    fn transition(&self, path: &str, given: &TransitionDefinition) -> Checked<Transition> {
        let from = match &given.from {
            Some(from) => Some(self.state(|| format!("{path}.from"), from)?),
            None => None,
        };
        if from.is_none() && given.when.is_empty() {
            let path = format!("{path}.when");
            return Err(at(path, StateMachineProblem::Unconditional));
        }
        let durations = [
            ("seconds", Some(given.seconds)),
            ("after", given.after),
            ("after_seconds", given.after_seconds),
        ];
        for (key, seconds) in durations {
            if let Some(seconds) = seconds.filter(|s| !(s.is_finite() && *s >= 0.0)) {
                let problem = StateMachineProblem::BadDuration { seconds };
                return Err(at(format!("{path}.{key}"), problem));
            }
        }
        let conditions = given.when.iter().enumerate();
        let conditions = conditions
            .map(|(index, condition)| self.condition(&format!("{path}.when[{index}]"), condition));
        Ok(Transition {
            from,
            to: self.state(|| format!("{path}.to"), &given.to)?,
            seconds: given.seconds,
            easing: given.easing,
            after: given.after,
            after_seconds: given.after_seconds,
            conditions: conditions.collect::<Checked<_>>()?,
            interruption: given.interruption,
        })
    }

    fn condition(&self, path: &str, given: &ConditionDefinition) -> Checked<Condition> {
        let names = self.parameters.iter().map(|(name, _)| name.as_str());
        let name = given.parameter.as_str();
        let parameter = find(|| format!("{path}.parameter"), "parameter", name, names)?;
        for (key, bound) in [("above", given.above), ("below", given.below)] {
            if let Some(bound) = bound {
                finite(|| format!("{path}.{key}"), f64::from(bound))?;
            }
        }
        let wrong = |kind, expected| {
            let parameter = given.parameter.clone();
            let problem = StateMachineProblem::WrongCondition {
                parameter,
                kind,
                expected,
            };
            Err(at(path, problem))
        };
        let bounds = given.above.is_some() || given.below.is_some();
        match (self.parameters[parameter].1, given.is) {
            (ParameterDefault::Number(_), None) if bounds => Ok(Condition::Between {
                parameter,
                above: given.above.unwrap_or(f32::NEG_INFINITY),
                below: given.below.unwrap_or(f32::INFINITY),
            }),
            (ParameterDefault::Number(_), _) => wrong("number", "`above`, `below` or both"),
            (ParameterDefault::Flag(_), Some(value)) if !bounds => {
                Ok(Condition::Is { parameter, value })
            }
            (ParameterDefault::Flag(_), _) => wrong("flag", "`is` and nothing else"),
            (ParameterDefault::Trigger(_), None) if !bounds => {
                Ok(Condition::Triggered { parameter })
            }
            (ParameterDefault::Trigger(_), _) => wrong("trigger", "neither bounds nor `is`"),
        }
    }

    /// The states' names.
    pub fn states(&self) -> impl Iterator<Item = &str> {
        self.states.iter().map(|state| state.name.as_str())
    }
}
