//! A playing state and the cross-fade into it.

use super::definition::Interruption;
use super::machine::{State, StateMachine};
use super::motion::Mix;
use crate::animation::{Clip, Cursor, Easing, Fired, Passage, Playhead, Pose, SizeMismatch};

/// Times within this distance count as equal, seconds; sums of steps are rounded.
pub(super) const MOMENT: f64 = 1e-9;

/// State with its playback position.
#[derive(Clone, Debug)]
pub(super) struct Playing {
    pub(super) state: usize,
    /// Time since the state was entered, seconds.
    pub(super) seconds: f64,
    /// Playback position in cycles, common to all clips.
    head: Playhead,
    /// Playback position when the state was entered, cycles.
    entered_at: f64,
    cursors: Vec<Cursor>,
}

impl Playing {
    pub(super) fn start(machine: &StateMachine, state: usize) -> Self {
        let backwards = machine.states[state].speed < 0.0;
        Self::start_at(machine, state, if backwards { 1.0 } else { 0.0 })
    }

    /// Starts a state at this state's fraction of the cycle.
    pub(super) fn start_in_step(&self, machine: &StateMachine, state: usize) -> Self {
        let playback = machine.states[self.state].playback;
        let place = playback.within(self.head.elapsed(), [0.0, 1.0]);
        Self::start_at(machine, state, place)
    }

    /// Starts a state at a position in cycles.
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

    /// Advances the state. Calls `on_event` for each passed event with its weight and the fraction of the step, while
    /// `budget` is positive. Returns false if the budget ran out.
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

    /// Writes the pose; `other` is a scratch pose.
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

    /// Cycles played since the state was entered; 1 if all clips have zero duration.
    pub(super) fn played(&self, state: &State) -> f64 {
        match state.motion.clips().any(|clip| clip.duration() > 0.0) {
            true => (self.head.elapsed() - self.entered_at).abs(),
            false => 1.0,
        }
    }

    /// Seconds until the clips have played `times` cycles; 0 if they have, infinite if they never will.
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

/// Cross-fade to the state being entered.
#[derive(Clone, Debug)]
pub(super) struct Fade {
    pub(super) from: Origin,
    pub(super) progress: Progress,
    pub(super) interruption: Interruption,
}

/// Source of a cross-fade.
#[derive(Clone, Debug)]
pub(super) enum Origin {
    /// A state that continues to play.
    State(Playing),
    /// The frozen pose of an interrupted cross-fade.
    Still(Pose),
}

impl Fade {
    /// The state being left.
    pub(super) fn leaving(&self) -> Option<&Playing> {
        match &self.from {
            Origin::State(from) => Some(from),
            Origin::Still(_) => None,
        }
    }
}

/// Progress of a cross-fade, in seconds.
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

    /// Advances; returns false once the cross-fade is over.
    pub(super) fn advance(&mut self, seconds: f64) -> bool {
        self.elapsed += seconds;
        self.left() > MOMENT
    }

    getters! {
        pub(super) fn left(&self) -> f64 = self.seconds - self.elapsed;
        /// Elapsed fraction of the duration.
        pub(super) fn of_time(&self) -> f32 = (self.elapsed / self.seconds) as f32;
    }

    /// Weight of the entered state in the pose, `ahead` seconds from now.
    pub(super) fn share(&self, ahead: f64) -> f32 {
        self.easing
            .at(((self.elapsed + ahead) / self.seconds) as f32)
    }
}
