//! One character's way through a state machine.

use std::sync::Arc;

use super::definition::ParameterDefault;
use super::event::StateEvent;
use super::machine::StateMachine;
use super::playing::{Fade, Origin, Playing};
use crate::animation::{Cursor, Pose, SizeMismatch};

/// Where one character is in a machine: its parameters, the state it is in, and the cross-fade that
/// is under way.
#[derive(Clone, Debug)]
pub struct StateMachineRun {
    pub(super) machine: Arc<StateMachine>,
    pub(super) values: Vec<ParameterDefault>,
    pub(super) triggered: Vec<bool>,
    pub(super) current: Playing,
    pub(super) fade: Option<Fade>,
    /// The transitions taken at this moment.
    pub(super) taken: Vec<usize>,
    /// Whether the last update passed more events than it may tell.
    events_left_out: bool,
    /// The pose as shown.
    pub(super) pose: Pose,
    /// What a cross-fade leads to, and room for what that is blended of.
    others: [Pose; 2],
}

impl StateMachineRun {
    /// The most transitions that one update takes.
    pub const MOST_TRANSITIONS: usize = 64;

    /// The most events that one update tells: a clip that is tiny beside the step passes its events
    /// without end.
    pub const MOST_EVENTS: usize = 1024;

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
            taken: Vec::new(),
            events_left_out: false,
            pose: rest.clone(),
            others: [rest.clone(), rest.clone()],
            machine,
        };
        let machine = Arc::clone(&own.machine);
        for state in &machine.states {
            for clip in state.motion.clips() {
                clip.sample(
                    clip.start(),
                    state.playback,
                    &mut Cursor::new(),
                    &mut own.pose,
                )?;
            }
        }
        own.show()?;
        Ok(own)
    }

    getters! {
        /// How long it has been in that state, in seconds, from the start of the cross-fade to it.
        pub fn seconds(&self) -> f64 = self.current.seconds;
        /// Whether the last update passed more than [`MOST_EVENTS`](Self::MOST_EVENTS) events, of which it
        /// told the first.
        pub fn events_left_out(&self) -> bool = self.events_left_out;
        /// The pose as of the last update.
        pub fn pose(&self) -> &Pose = &self.pose;
        /// The state that it is in or on the way to.
        pub fn state(&self) -> &str = &self.machine.states[self.current.state].name;
    }

    /// How many times through that state's clips have played since it was entered: 0.5 is half of it. 1
    /// for clips that last no time.
    #[must_use]
    pub fn played(&self) -> f64 {
        self.current
            .played(&self.machine.states[self.current.state])
    }

    /// The names of that state's clips that play now, with their weights; the weights sum to 1.
    pub fn playing(&self) -> impl Iterator<Item = (&str, f32)> {
        let motion = &self.machine.states[self.current.state].motion;
        let clips = motion.playing(motion.mix(&self.values));
        clips.map(|(clip, weight)| (clip.name(), weight))
    }

    /// How far the cross-fade to the state is, as the share of its time within [0, 1); `None` when
    /// there is none.
    #[must_use]
    pub fn fading(&self) -> Option<f32> {
        self.fade.as_ref().map(|fade| fade.progress.of_time())
    }

    /// The state that a cross-fade comes from; `None` when there is none, or when it comes from the
    /// pose in which another one was broken off.
    #[must_use]
    pub fn leaving(&self) -> Option<&str> {
        let leaving = self.fade.as_ref()?.leaving()?;
        Some(&self.machine.states[leaving.state].name)
    }

    /// Goes on by so many seconds: plays the clips, takes transitions at the moments at which they may
    /// be taken, and blends. A long step ends where many short ones do. A transition that time opens at
    /// the very end of a step is taken as the next one begins.
    ///
    /// At one moment each transition is taken at most once, so transitions that lead in a ring stop;
    /// and after [`MOST_TRANSITIONS`](Self::MOST_TRANSITIONS) in one update, the rest of its time is
    /// spent in the state entered last. `on_event` hears the events of the clips, also of a state that
    /// is being left, but no more than [`MOST_EVENTS`](Self::MOST_EVENTS) in one update; whether there were more,
    /// [`events_left_out`](Self::events_left_out) says. Seconds that are negative or not finite count as 0.
    ///
    /// # Errors
    /// Never for a run that [`new`](Self::new) made; sizes were checked there.
    pub fn update(
        &mut self,
        seconds: f64,
        mut on_event: impl FnMut(StateEvent<'_>),
    ) -> Result<(), SizeMismatch> {
        let machine = Arc::clone(&self.machine);
        let mut left = if seconds.is_finite() {
            seconds.max(0.0)
        } else {
            0.0
        };
        let mut most = Self::MOST_TRANSITIONS;
        let mut budget = Self::MOST_EVENTS;
        self.events_left_out = false;
        loop {
            most -= self.take_all(&machine, most)?;
            let step = match most {
                0 => left,
                _ => left.min(self.until_change(&machine)),
            };
            self.advance(&machine, step, &mut budget, &mut on_event);
            left -= step;
            if left <= 0.0 {
                return self.show();
            }
        }
    }

    /// Plays on, within one stretch without transitions.
    fn advance(
        &mut self,
        machine: &StateMachine,
        seconds: f64,
        budget: &mut usize,
        on_event: &mut impl FnMut(StateEvent<'_>),
    ) {
        let mut all = true;
        let progress = self.fade.as_ref().map(|fade| fade.progress);
        // The share of the state that is being entered, at a share of this step.
        let entered = |at: f64| progress.map_or(1.0, |progress| progress.share(at * seconds));
        if let Some(fade) = &mut self.fade {
            if let Origin::State(from) = &mut fade.from {
                let state = &machine.states[from.state];
                let mix = state.motion.mix(&self.values);
                all &= from.advance(state, mix, seconds, budget, |clip, weight, fired, at| {
                    on_event(StateEvent {
                        state: &state.name,
                        clip: clip.name(),
                        event: fired.event,
                        weight: weight * (1.0 - entered(at)),
                    });
                });
            }
            if !fade.progress.advance(seconds) {
                self.fade = None;
            }
        }
        let state = &machine.states[self.current.state];
        let mix = state.motion.mix(&self.values);
        all &= self
            .current
            .advance(state, mix, seconds, budget, |clip, weight, fired, at| {
                on_event(StateEvent {
                    state: &state.name,
                    clip: clip.name(),
                    event: fired.event,
                    weight: weight * entered(at),
                });
            });
        self.events_left_out |= !all;
    }

    /// Writes the pose.
    pub(super) fn show(&mut self) -> Result<(), SizeMismatch> {
        let [other, third] = &mut self.others;
        let mut sample = |playing: &mut Playing, pose: &mut Pose| {
            let state = &self.machine.states[playing.state];
            playing.sample(state, state.motion.mix(&self.values), pose, third)
        };
        let Some(fade) = &mut self.fade else {
            return sample(&mut self.current, &mut self.pose);
        };
        match &mut fade.from {
            Origin::State(from) => sample(from, &mut self.pose)?,
            Origin::Still(still) => self.pose.copy_from(still),
        }
        sample(&mut self.current, other)?;
        self.pose.cross_fade(other, fade.progress.share(0.0))
    }
}
