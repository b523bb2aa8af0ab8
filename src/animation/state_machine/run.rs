//! Run of a state machine for one character.

use std::sync::Arc;

use super::definition::ParameterDefault;
use super::event::StateEvent;
use super::machine::StateMachine;
use super::playing::{Fade, Origin, Playing};
use crate::animation::{Cursor, Pose, SizeMismatch};

/// Run of a machine for one character: parameters, current state and running cross-fade.
#[derive(Clone, Debug)]
pub struct StateMachineRun {
    pub(super) machine: Arc<StateMachine>,
    pub(super) values: Vec<ParameterDefault>,
    pub(super) triggered: Vec<bool>,
    pub(super) current: Playing,
    pub(super) fade: Option<Fade>,
    /// Transitions taken at the current time.
    pub(super) taken: Vec<usize>,
    /// True if the last update passed more events than it may report.
    events_left_out: bool,
    /// Current pose.
    pub(super) pose: Pose,
    /// Scratch poses: the target of a cross-fade and a buffer for blends.
    others: [Pose; 2],
}

impl StateMachineRun {
    /// Largest number of transitions in one update.
    pub const MOST_TRANSITIONS: usize = 64;

    /// Largest number of events reported in one update. A clip much shorter than the step would otherwise report events
    /// without bound.
    pub const MOST_EVENTS: usize = 1024;

    /// A run in the machine's initial state. `rest` is the rest pose of the character's armature.
    ///
    /// # Errors
    /// The pose is of another armature than the clips.
    pub fn new(machine: Arc<StateMachine>, rest: &Pose) -> Result<Self, SizeMismatch> {
        let mut run = Self {
            values: machine.parameters.iter().map(|(_, value)| *value).collect(),
            triggered: vec![false; machine.parameters.len()],
            current: Playing::start(&machine, machine.initial),
            fade: None,
            taken: Vec::new(),
            events_left_out: false,
            pose: rest.clone(),
            others: [rest.clone(), rest.clone()],
            machine,
        };
        let machine = Arc::clone(&run.machine);
        for state in &machine.states {
            for clip in state.motion.clips() {
                clip.sample(
                    clip.start(),
                    state.playback,
                    &mut Cursor::new(),
                    &mut run.pose,
                )?;
            }
        }
        run.update_pose()?;
        Ok(run)
    }

    /// Time in the current state in seconds, from the start of the cross-fade to it.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.current.seconds
    }

    /// Returns true if the last update passed more than [`MOST_EVENTS`](Self::MOST_EVENTS) events; only the first
    /// ones were reported.
    #[must_use]
    pub fn events_left_out(&self) -> bool {
        self.events_left_out
    }

    /// Pose after the last update.
    #[must_use]
    pub fn pose(&self) -> &Pose {
        &self.pose
    }

    /// Current state, or the target of the running cross-fade.
    #[must_use]
    pub fn state(&self) -> &str {
        &self.machine.states[self.current.state].name
    }

    /// Cycles of the current state's clips since it was entered; 0.5 is half a cycle. 1 if all clips have zero
    /// duration.
    #[must_use]
    pub fn played(&self) -> f64 {
        self.current
            .played(&self.machine.states[self.current.state])
    }

    /// Names of the current state's active clips with their weights, which sum to 1.
    pub fn playing(&self) -> impl Iterator<Item = (&str, f32)> {
        let motion = &self.machine.states[self.current.state].motion;
        let clips = motion.playing(motion.mix(&self.values));
        clips.map(|(clip, weight)| (clip.name(), weight))
    }

    /// Progress of the cross-fade as the fraction of its duration within [0, 1); `None` without a cross-fade.
    #[must_use]
    pub fn fading(&self) -> Option<f32> {
        self.fade.as_ref().map(|fade| fade.progress.time_fraction())
    }

    /// Source state of the cross-fade; `None` without a cross-fade, or if it starts from the pose of an interrupted
    /// one.
    #[must_use]
    pub fn leaving(&self) -> Option<&str> {
        let leaving = self.fade.as_ref()?.leaving()?;
        Some(&self.machine.states[leaving.state].name)
    }

    /// Advances by `seconds`: plays the clips, takes transitions at their times, and blends. One long step ends in the
    /// same state as many short ones. A transition that becomes possible exactly at the end of a step is taken in the
    /// next one.
    ///
    /// At one time each transition is taken at most once, so cycles of transitions end. After
    /// [`MOST_TRANSITIONS`](Self::MOST_TRANSITIONS) in one update, the remaining time is spent in the last state.
    ///
    /// `on_event` receives the events of the clips, including those of a state being left. At most
    /// [`MOST_EVENTS`](Self::MOST_EVENTS) are reported in one update; [`events_left_out`](Self::events_left_out)
    /// returns true if there were more. A negative or non-finite `seconds` counts as 0.
    ///
    /// # Errors
    /// None for a run made by [`new`](Self::new), which checks the sizes.
    pub fn update(
        &mut self,
        seconds: f64,
        mut on_event: impl FnMut(StateEvent<'_>),
    ) -> Result<(), SizeMismatch> {
        let machine = Arc::clone(&self.machine);
        let mut remaining = if seconds.is_finite() {
            seconds.max(0.0)
        } else {
            0.0
        };
        let mut transitions_left = Self::MOST_TRANSITIONS;
        let mut budget = Self::MOST_EVENTS;
        self.events_left_out = false;
        loop {
            transitions_left -= self.take_transitions(&machine, transitions_left)?;
            let step = match transitions_left {
                0 => remaining,
                _ => remaining.min(self.seconds_until_change(&machine)),
            };
            self.advance(&machine, step, &mut budget, &mut on_event);
            remaining -= step;
            if remaining <= 0.0 {
                return self.update_pose();
            }
        }
    }

    /// Advances within an interval without transitions.
    fn advance(
        &mut self,
        machine: &StateMachine,
        seconds: f64,
        budget: &mut usize,
        on_event: &mut impl FnMut(StateEvent<'_>),
    ) {
        let mut is_complete = true;
        let progress = self.fade.as_ref().map(|fade| fade.progress);
        // Weight of the entered state at a fraction of this step.
        let entered =
            |fraction: f64| progress.map_or(1.0, |progress| progress.weight_at(fraction * seconds));
        if let Some(fade) = &mut self.fade {
            if let Origin::State(from) = &mut fade.from {
                let state = &machine.states[from.state];
                let mix = state.motion.mix(&self.values);
                is_complete &= from.advance(
                    state,
                    mix,
                    seconds,
                    budget,
                    |clip, weight, fired, fraction| {
                        on_event(StateEvent {
                            state: &state.name,
                            clip: clip.name(),
                            event: fired.event,
                            weight: weight * (1.0 - entered(fraction)),
                        });
                    },
                );
            }
            if !fade.progress.advance(seconds) {
                self.fade = None;
            }
        }
        let state = &machine.states[self.current.state];
        let mix = state.motion.mix(&self.values);
        is_complete &= self.current.advance(
            state,
            mix,
            seconds,
            budget,
            |clip, weight, fired, fraction| {
                on_event(StateEvent {
                    state: &state.name,
                    clip: clip.name(),
                    event: fired.event,
                    weight: weight * entered(fraction),
                });
            },
        );
        self.events_left_out |= !is_complete;
    }

    /// Writes the pose.
    pub(super) fn update_pose(&mut self) -> Result<(), SizeMismatch> {
        let [other, buffer] = &mut self.others;
        let mut sample = |playing: &mut Playing, pose: &mut Pose| {
            let state = &self.machine.states[playing.state];
            playing.sample(state, state.motion.mix(&self.values), pose, buffer)
        };
        let Some(fade) = &mut self.fade else {
            return sample(&mut self.current, &mut self.pose);
        };
        match &mut fade.from {
            Origin::State(from) => sample(from, &mut self.pose)?,
            Origin::Still(pose) => self.pose.copy_from(pose),
        }
        sample(&mut self.current, other)?;
        self.pose.cross_fade(other, fade.progress.weight_at(0.0))
    }
}
