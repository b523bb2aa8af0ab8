//! A state that plays, and what it fades from.

use super::definition::Interruption;
use super::machine::{State, StateMachine};
use super::motion::Mix;
use crate::animation::{Clip, Cursor, Easing, Fired, Passage, Playhead, Pose, SizeMismatch};

/// Moments this near, in seconds, are one: sums of steps are rounded.
pub(super) const MOMENT: f64 = 1e-9;

/// A state and where its clips are.
#[derive(Clone, Debug)]
pub(super) struct Playing {
    pub(super) state: usize,
    /// Since the state was entered.
    pub(super) seconds: f64,
    /// In times through the clips, which keep step.
    head: Playhead,
    /// Where the head was as the state was entered.
    entered_at: f64,
    cursors: Vec<Cursor>,
}

impl Playing {
    pub(super) fn start(machine: &StateMachine, state: usize) -> Self {
        let backwards = machine.states[state].speed < 0.0;
        Self::start_at(machine, state, if backwards { 1.0 } else { 0.0 })
    }

    /// Starts a state at the place in its clips at which this one is.
    pub(super) fn start_in_step(&self, machine: &StateMachine, state: usize) -> Self {
        let playback = machine.states[self.state].playback;
        let place = playback.within(self.head.elapsed(), [0.0, 1.0]);
        Self::start_at(machine, state, place)
    }

    /// Starts a state at a place in its clips, in times through.
    fn start_at(machine: &StateMachine, state: usize, place: f64) -> Self {
        let entered = &machine.states[state];
        let mut head = Playhead::starting_at(place);
        head.speed = entered.speed;
        Self {
            state,
            seconds: 0.0,
            head,
            entered_at: place,
            cursors: vec![Cursor::new(); entered.motion.clips().len()],
        }
    }

    /// Plays on; `on_event` hears each event passed by a clip with its weight, and the share of the
    /// step at which it was, while there is any budget of them left. Says whether it heard all.
    pub(super) fn advance(
        &mut self,
        state: &State,
        mix: Mix,
        seconds: f64,
        budget: &mut usize,
        mut on_event: impl FnMut(&Clip, f32, Fired<'_>, f64),
    ) -> bool {
        self.seconds += seconds;
        let length = state.motion.length(mix);
        let times = if length > 0.0 { seconds / length } else { 0.0 };
        let passage = self.head.advance(times);
        let playing = state.motion.playing(mix);
        let mut all = true;
        for (clip, weight) in playing.filter(|(clip, _)| !clip.events().is_empty()) {
            let [from, to] = [passage.from, passage.to].map(|times| times * clip.duration());
            let passage = Passage {
                from,
                to,
                ..passage
            };
            for fired in clip.fired(state.playback, passage) {
                if *budget == 0 {
                    all = false;
                    break;
                }
                *budget -= 1;
                let share = if from == to {
                    0.0
                } else {
                    (fired.elapsed - from) / (to - from)
                };
                on_event(clip, weight, fired, share);
            }
        }
        all
    }

    /// Writes the pose; `other` is room for one.
    pub(super) fn sample(
        &mut self,
        state: &State,
        mix: Mix,
        pose: &mut Pose,
        other: &mut Pose,
    ) -> Result<(), SizeMismatch> {
        let mut sample = |index: usize, pose: &mut Pose| {
            let clip = state.motion.clip(index);
            let time = clip.start() + self.head.elapsed() * clip.duration();
            clip.sample(time, state.playback, &mut self.cursors[index], pose)
        };
        sample(mix.first, pose)?;
        if mix.share > 0.0 {
            sample(mix.first + 1, other)?;
            pose.cross_fade(other, mix.share)?;
        }
        Ok(())
    }

    /// How many times through the clips have played since the state was entered; 1 where all last no
    /// time.
    pub(super) fn played(&self, state: &State) -> f64 {
        match state.motion.clips().any(|clip| clip.duration() > 0.0) {
            true => (self.head.elapsed() - self.entered_at).abs(),
            false => 1.0,
        }
    }

    /// The seconds until the clips have played so many times through, 0 where they have; infinite
    /// where they never will.
    pub(super) fn until_played(&self, state: &State, mix: Mix, times: f64) -> f64 {
        let missing = times - self.played(state);
        let each = state.motion.length(mix) / state.speed.abs();
        match missing <= 0.0 {
            true => 0.0,
            false if each > 0.0 => missing * each,
            false => f64::INFINITY,
        }
    }
}

/// A cross-fade to the state that is being entered.
#[derive(Clone, Debug)]
pub(super) struct Fade {
    pub(super) from: Origin,
    pub(super) progress: Progress,
    pub(super) interruption: Interruption,
}

/// What a cross-fade comes from.
#[derive(Clone, Debug)]
pub(super) enum Origin {
    /// A state that plays on.
    State(Playing),
    /// The pose as it was shown when a fade was broken off, which stands still.
    Still(Pose),
}

impl Fade {
    /// The state that is being left.
    pub(super) fn leaving(&self) -> Option<&Playing> {
        match &self.from {
            Origin::State(from) => Some(from),
            Origin::Still(_) => None,
        }
    }
}

/// How far a cross-fade is; all in seconds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Progress {
    elapsed: f64,
    seconds: f64,
    easing: Easing,
}

impl Progress {
    pub(super) fn new(seconds: f64, easing: Easing) -> Self {
        Self {
            elapsed: 0.0,
            seconds,
            easing,
        }
    }

    /// Goes on; false once it is over.
    pub(super) fn advance(&mut self, seconds: f64) -> bool {
        self.elapsed += seconds;
        self.left() > MOMENT
    }

    getters! {
        pub(super) fn left(&self) -> f64 = self.seconds - self.elapsed;
        /// The share of its time.
        pub(super) fn of_time(&self) -> f32 = (self.elapsed / self.seconds) as f32;
    }

    /// How much of the pose is the state's that is being entered, so many seconds from now.
    pub(super) fn share(&self, ahead: f64) -> f32 {
        self.easing
            .at(((self.elapsed + ahead) / self.seconds) as f32)
    }
}
