//! One character's way through a state machine.

use std::sync::Arc;

use super::definition::{Interruption, ParameterDefault};
use super::machine::{Condition, State, StateMachine, Transition};
use crate::animation::{Cursor, Easing, Fired, Playhead, Pose, SizeMismatch};
use crate::model::UnknownName;

/// A value for a parameter of another kind, or a parameter that does not exist.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ParameterError {
    /// No parameter of that name.
    #[error("no {} named `{}`; there are: {}", .0.kind, .0.name, .0.valid.join(", "))]
    Unknown(UnknownName),
    /// A number that is not finite.
    #[error("parameter `{parameter}`: {value} is not finite")]
    NotFinite {
        /// The parameter.
        parameter: String,
        /// The number.
        value: f32,
    },
}

/// Where one character is in a machine: its parameters, the state it is in, and the cross-fade that
/// is under way.
#[derive(Clone, Debug)]
pub struct StateMachineRun {
    machine: Arc<StateMachine>,
    values: Vec<ParameterDefault>,
    triggered: Vec<bool>,
    current: Playing,
    fade: Option<Fade>,
    /// The pose as shown.
    pose: Pose,
    /// What a cross-fade leads to, or comes from.
    other: Pose,
}

/// A state and where its clip is.
#[derive(Clone, Debug)]
struct Playing {
    state: usize,
    head: Playhead,
    cursor: Cursor,
}

/// A cross-fade from what was before.
#[derive(Clone, Debug)]
struct Fade {
    /// `None` once it was broken off: then it comes from a pose that stands still.
    from: Option<Playing>,
    frozen: Option<Pose>,
    elapsed: f64,
    seconds: f64,
    easing: Easing,
    interruption: Interruption,
}

impl Playing {
    fn start(machine: &StateMachine, state: usize) -> Self {
        let mut head = Playhead::new();
        let entered = &machine.states[state];
        if entered.speed < 0.0 {
            head = Playhead::starting_at(entered.clip.duration());
        }
        head.speed = entered.speed;
        Self {
            state,
            head,
            cursor: Cursor::new(),
        }
    }

    fn sample(&mut self, state: &State, pose: &mut Pose) -> Result<(), SizeMismatch> {
        let elapsed = self.head.elapsed();
        state
            .clip
            .sample(elapsed, state.playback, &mut self.cursor, pose)
    }

    /// How many times the clip has played through.
    fn played(&self, state: &State) -> f64 {
        let length = state.clip.duration();
        let [start, end] = match state.speed < 0.0 {
            true => [length, self.head.elapsed()],
            false => [0.0, self.head.elapsed()],
        };
        if length > 0.0 {
            (end - start).abs() / length
        } else {
            1.0
        }
    }
}

impl StateMachineRun {
    /// A character in the machine's initial state. `rest` is the rest pose of its armature.
    ///
    /// # Errors
    /// The pose is of another armature than the clips.
    pub fn new(machine: Arc<StateMachine>, rest: &Pose) -> Result<Self, SizeMismatch> {
        let mut own = Self {
            values: machine.parameters.iter().map(|(_, value)| *value).collect(),
            triggered: vec![false; machine.parameters.len()],
            current: Playing::start(&machine, machine.initial),
            fade: None,
            pose: rest.clone(),
            other: rest.clone(),
            machine,
        };
        let machine = Arc::clone(&own.machine);
        for state in &machine.states {
            state
                .clip
                .sample(0.0, state.playback, &mut Cursor::new(), &mut own.pose)?;
        }
        own.show()?;
        Ok(own)
    }

    fn parameter(
        &self,
        kind: &'static str,
        name: &str,
        suits: fn(&ParameterDefault) -> bool,
    ) -> Result<usize, ParameterError> {
        let parameters = self.machine.parameters.iter();
        let position = parameters
            .clone()
            .position(|(own, d)| own == name && suits(d));
        position.ok_or_else(|| {
            let valid = parameters
                .filter(|(_, d)| suits(d))
                .map(|(own, _)| own.as_str());
            ParameterError::Unknown(UnknownName::new(kind, name, valid))
        })
    }

    /// Sets a number.
    ///
    /// # Errors
    /// No number of that name (the error lists them), or a value that is not finite.
    pub fn set_number(&mut self, name: &str, value: f32) -> Result<(), ParameterError> {
        let is_number = |d: &ParameterDefault| matches!(d, ParameterDefault::Number(_));
        let index = self.parameter("number", name, is_number)?;
        if !value.is_finite() {
            let parameter = name.to_owned();
            return Err(ParameterError::NotFinite { parameter, value });
        }
        self.values[index] = ParameterDefault::Number(value);
        Ok(())
    }

    /// Sets a flag.
    ///
    /// # Errors
    /// No flag of that name; the error lists them.
    pub fn set_flag(&mut self, name: &str, value: bool) -> Result<(), ParameterError> {
        let is_flag = |d: &ParameterDefault| matches!(d, ParameterDefault::Flag(_));
        let index = self.parameter("flag", name, is_flag)?;
        self.values[index] = ParameterDefault::Flag(value);
        Ok(())
    }

    /// Sets a trigger, until a transition takes it.
    ///
    /// # Errors
    /// No trigger of that name; the error lists them.
    pub fn trigger(&mut self, name: &str) -> Result<(), ParameterError> {
        let is_trigger = |d: &ParameterDefault| matches!(d, ParameterDefault::Trigger(_));
        let index = self.parameter("trigger", name, is_trigger)?;
        self.triggered[index] = true;
        Ok(())
    }

    /// The state that it is in or on the way to.
    #[must_use]
    pub fn state(&self) -> &str {
        &self.machine.states[self.current.state].name
    }

    /// How far the cross-fade to the state is, within [0, 1); `None` when there is none.
    #[must_use]
    pub fn fading(&self) -> Option<f32> {
        let fade = self.fade.as_ref()?;
        Some((fade.elapsed / fade.seconds) as f32)
    }

    /// The pose as of the last update.
    #[must_use]
    pub fn pose(&self) -> &Pose {
        &self.pose
    }

    /// Goes on by so many seconds: takes at most one transition, plays the clips, and blends.
    /// `on_event` hears the events of the clip of the state that it is in.
    ///
    /// # Errors
    /// Never for a run that [`new`](Self::new) made; sizes were checked there.
    pub fn update(
        &mut self,
        seconds: f64,
        mut on_event: impl FnMut(Fired<'_>),
    ) -> Result<(), SizeMismatch> {
        let machine = Arc::clone(&self.machine);
        if let Some(transition) = self.next(&machine) {
            self.take(&machine, transition);
        }
        let seconds = if seconds.is_finite() {
            seconds.max(0.0)
        } else {
            0.0
        };
        let state = &machine.states[self.current.state];
        let passage = self.current.head.advance(seconds);
        state
            .clip
            .fired(state.playback, passage)
            .for_each(&mut on_event);
        if let Some(fade) = &mut self.fade {
            fade.elapsed += seconds;
            if let Some(from) = &mut fade.from {
                from.head.advance(seconds);
            }
        }
        self.fade = self.fade.take().filter(|fade| fade.elapsed < fade.seconds);
        self.show()
    }

    /// Writes the pose.
    fn show(&mut self) -> Result<(), SizeMismatch> {
        let states = &self.machine.states;
        let state = &states[self.current.state];
        let Some(fade) = &mut self.fade else {
            return self.current.sample(state, &mut self.pose);
        };
        match (&mut fade.from, &fade.frozen) {
            (Some(from), _) => from.sample(&states[from.state], &mut self.pose)?,
            (None, Some(frozen)) => self.pose.copy_from(frozen),
            (None, None) => {}
        }
        self.current.sample(state, &mut self.other)?;
        let share = fade.easing.at((fade.elapsed / fade.seconds) as f32);
        self.pose.cross_fade(&self.other, share)
    }

    /// The first transition whose conditions hold.
    fn next<'m>(&self, machine: &'m StateMachine) -> Option<&'m Transition> {
        let current = self.current.state;
        let Some(fade) = &self.fade else {
            return self.first(machine, &self.current, current);
        };
        let source = fade.from.as_ref().filter(|_| {
            matches!(
                fade.interruption,
                Interruption::Source | Interruption::Either
            )
        });
        let from_source = source.and_then(|from| self.first(machine, from, current));
        from_source.or_else(|| match fade.interruption {
            Interruption::Target | Interruption::Either => {
                self.first(machine, &self.current, current)
            }
            Interruption::Source | Interruption::Never => None,
        })
    }

    /// The first of a state's transitions, other than to where it is going already.
    fn first<'m>(
        &self,
        machine: &'m StateMachine,
        playing: &Playing,
        going: usize,
    ) -> Option<&'m Transition> {
        let state = &machine.states[playing.state];
        machine.transitions.iter().find(|transition| {
            let leaves = match transition.from {
                Some(from) => {
                    from == playing.state && (self.fade.is_none() || transition.to != going)
                }
                None => transition.to != going,
            };
            let late = transition
                .after
                .is_none_or(|share| playing.played(state) >= share);
            leaves && late && transition.conditions.iter().all(|c| self.holds(*c))
        })
    }

    fn holds(&self, condition: Condition) -> bool {
        match condition {
            Condition::Between {
                parameter,
                above,
                below,
            } => match self.values[parameter] {
                ParameterDefault::Number(value) => above < value && value < below,
                _ => false,
            },
            Condition::Is { parameter, value } => {
                self.values[parameter] == ParameterDefault::Flag(value)
            }
            Condition::Triggered { parameter } => self.triggered[parameter],
        }
    }

    fn take(&mut self, machine: &StateMachine, transition: &Transition) {
        for condition in &transition.conditions {
            if let Condition::Triggered { parameter } = condition {
                self.triggered[*parameter] = false;
            }
        }
        let entered = Playing::start(machine, transition.to);
        let left = std::mem::replace(&mut self.current, entered);
        // A fade that is broken off goes on from the pose as it is shown.
        let broken = self.fade.take().is_some();
        self.fade = (transition.seconds > 0.0).then(|| Fade {
            from: (!broken).then_some(left),
            frozen: broken.then(|| self.pose.clone()),
            elapsed: 0.0,
            seconds: transition.seconds,
            easing: transition.easing,
            interruption: transition.interruption,
        });
    }
}
