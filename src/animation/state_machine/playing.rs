//! A state that plays, and what it fades from.

use super::definition::Interruption;
use super::machine::{State, StateMachine};
use crate::animation::{Cursor, Easing, Fired, Passage, Playhead, Pose, SizeMismatch};

/// Moments this near, in seconds, are one: sums of steps are rounded.
pub(super) const MOMENT: f64 = 1e-9;

/// A state and where its clip is.
#[derive(Clone, Debug)]
pub(super) struct Playing {
    pub(super) state: usize,
    /// Since the state was entered.
    pub(super) seconds: f64,
    head: Playhead,
    cursor: Cursor,
}

impl Playing {
    pub(super) fn start(machine: &StateMachine, state: usize) -> Self {
        let mut head = Playhead::new();
        let entered = &machine.states[state];
        if entered.speed < 0.0 {
            head = Playhead::starting_at(entered.clip.duration());
        }
        head.speed = entered.speed;
        Self {
            state,
            seconds: 0.0,
            head,
            cursor: Cursor::new(),
        }
    }

    /// Plays on; `on_event` hears each event passed with the share of the step at which it was.
    pub(super) fn advance(
        &mut self,
        state: &State,
        seconds: f64,
        mut on_event: impl FnMut(Fired<'_>, f64),
    ) {
        self.seconds += seconds;
        let passage = self.head.advance(seconds);
        let Passage { from, to, .. } = passage;
        for fired in state.clip.fired(state.playback, passage) {
            let share = if from == to {
                0.0
            } else {
                (fired.elapsed - from) / (to - from)
            };
            on_event(fired, share);
        }
    }

    pub(super) fn sample(&mut self, state: &State, pose: &mut Pose) -> Result<(), SizeMismatch> {
        let elapsed = self.head.elapsed();
        state
            .clip
            .sample(elapsed, state.playback, &mut self.cursor, pose)
    }

    /// How many times the clip has played through; 1 for one that lasts no time.
    pub(super) fn played(&self, state: &State) -> f64 {
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

    /// The seconds until the clip has played so many times through, negative where it has; infinite
    /// where it never will.
    pub(super) fn until_played(&self, state: &State, times: f64) -> f64 {
        let missing = times - self.played(state);
        let each = state.clip.duration() / state.speed.abs();
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

    pub(super) fn left(&self) -> f64 {
        self.seconds - self.elapsed
    }

    /// The share of its time.
    pub(super) fn of_time(&self) -> f32 {
        (self.elapsed / self.seconds) as f32
    }

    /// How much of the pose is the state's that is being entered, so many seconds from now.
    pub(super) fn share(&self, ahead: f64) -> f32 {
        self.easing
            .at(((self.elapsed + ahead) / self.seconds) as f32)
    }
}
