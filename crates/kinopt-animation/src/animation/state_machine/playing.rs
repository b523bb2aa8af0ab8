//! A playing state and the cross-fade into it.

use super::definition::Interruption;
use super::machine::{State, StateMachine};
use super::motion::Mix;
use crate::animation::{Clip, Cursor, Easing, Fired, Passage, Playhead, Pose, SizeMismatch};

/// Times within this distance count as equal, seconds; sums of steps are rounded.
pub(super) const TIME_TOLERANCE: f64 = 1e-9;

/// State with its playback position.
#[derive(Clone, Debug)]
pub(super) struct Playing {
    pub(super) state: usize,
    /// Time since the state was entered, seconds.
    pub(super) seconds: f64,
    /// Playback position in cycles, common to all clips.
    playhead: Playhead,
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
        let position = playback.within(self.playhead.elapsed(), [0.0, 1.0]);
        Self::start_at(machine, state, position)
    }

    /// Starts a state at a position in cycles.
    fn start_at(machine: &StateMachine, state: usize, position: f64) -> Self {
        let entered = &machine.states[state];
        let mut playhead = Playhead::starting_at(position);
        playhead.speed = entered.speed;
        Self {
            state,
            seconds: 0.0,
            playhead,
            entered_at: position,
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
        let cycles = if length > 0.0 { seconds / length } else { 0.0 };
        let passage = self.playhead.advance(cycles);
        let playing = state.motion.playing(mix);
        let mut is_complete = true;
        for (clip, weight) in playing.filter(|(clip, _)| !clip.events().is_empty()) {
            let [from, to] = [passage.from, passage.to].map(|cycles| cycles * clip.duration());
            let passage = Passage {
                from,
                to,
                ..passage
            };
            for fired in clip.fired(state.playback, passage) {
                if *budget == 0 {
                    is_complete = false;
                    break;
                }
                *budget -= 1;
                let fraction = if from == to {
                    0.0
                } else {
                    (fired.elapsed - from) / (to - from)
                };
                on_event(clip, weight, fired, fraction);
            }
        }
        is_complete
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
            let time = clip.start() + self.playhead.elapsed() * clip.duration();
            clip.sample(time, state.playback, &mut self.cursors[index], pose)
        };
        sample(mix.first, pose)?;
        if mix.next_weight > 0.0 {
            sample(mix.first + 1, other)?;
            pose.cross_fade(other, mix.next_weight)?;
        }
        Ok(())
    }

    /// Cycles played since the state was entered; 1 if all clips have zero duration.
    pub(super) fn played(&self, state: &State) -> f64 {
        match state.motion.clips().any(|clip| clip.duration() > 0.0) {
            true => (self.playhead.elapsed() - self.entered_at).abs(),
            false => 1.0,
        }
    }

    /// Seconds until the clips have played `cycles` cycles; 0 if they have, infinite if they never will.
    pub(super) fn seconds_until_played(&self, state: &State, mix: Mix, cycles: f64) -> f64 {
        let remaining_cycles = cycles - self.played(state);
        let cycle_seconds = state.motion.length(mix) / state.speed.abs();
        match remaining_cycles <= 0.0 {
            true => 0.0,
            false if cycle_seconds > 0.0 => remaining_cycles * cycle_seconds,
            false => f64::INFINITY,
        }
    }
}

/// Cross-fade to the state being entered.
#[derive(Clone, Debug)]
pub(super) struct Fade {
    pub(super) from: Origin,
    pub(super) progress: FadeProgress,
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
pub(super) struct FadeProgress {
    elapsed: f64,
    seconds: f64,
    easing: Easing,
}

impl FadeProgress {
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
        self.remaining() > TIME_TOLERANCE
    }

    #[must_use]
    pub(super) fn remaining(&self) -> f64 {
        self.seconds - self.elapsed
    }

    /// Elapsed fraction of the duration.
    #[must_use]
    pub(super) fn time_fraction(&self) -> f32 {
        (self.elapsed / self.seconds) as f32
    }

    /// Weight of the entered state in the pose, `ahead` seconds from now.
    pub(super) fn weight_at(&self, lookahead: f64) -> f32 {
        self.easing
            .at(((self.elapsed + lookahead) / self.seconds) as f32)
    }
}
