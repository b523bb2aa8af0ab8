//! Numbered attempts: where each one starts, and which one counts.
//!
//! Attempt 0 is the caller's start. The first few attempts give up as soon as they stall, because
//! another start most often does better than patience; if none arrives, the best of them is
//! finished, and the others run to their ends.
//!
//! Attempt i > 0 is drawn from (seed, i) alone, so attempts could
//! run in any order; the lowest index that succeeds wins.

use crate::problem::Problem;
use crate::random::RandomStream;

/// How far a nudged start moves towards a random one. Rest poses of rigs are singular: with a bend
/// of 0 both twists coincide, and a small move away shows the way.
const NUDGE: f64 = 0.15;

/// How many attempts give up when they stall.
const QUICK_ATTEMPTS: usize = 8;
/// Steps without halving the cost after which a quick attempt gives up. The caller's start is most
/// often a neighbour of the answer, which is then found at once, or a singular rest pose, which
/// leads nowhere.
const PATIENCE_AT_START: usize = 6;
const PATIENCE: usize = 10;

/// How many attempts after the first leave alone what already is where it should be.
const LOCAL_ATTEMPTS: usize = 2;

/// One run of the method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Trial {
    /// An attempt that gives up when it stalls.
    Quick(usize),
    /// The best attempt so far goes on to its end, if it gave up when it stalled.
    FinishBest,
    /// An attempt that runs to its end.
    Full(usize),
    /// When the steps are used up, the best of all goes on, unless it came to its end.
    FinishAtLast,
}

impl Trial {
    /// Whether the trial's end says something of its own about what can be reached: nudged starts
    /// fall into the hole that the start is in.
    pub(super) fn counts_for_agreement(self) -> bool {
        match self {
            Self::Quick(index) | Self::Full(index) => index % 2 == 0,
            Self::FinishBest | Self::FinishAtLast => true,
        }
    }

    /// Whether the trial goes on from where the best one stands.
    pub(super) fn goes_on(self) -> bool {
        matches!(self, Self::FinishBest | Self::FinishAtLast)
    }
}

/// How often to try again, and from where.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Restarts {
    pub(crate) attempts: usize,
    pub(super) seed: u64,
    pub(crate) agreeing: usize,
    pub(crate) steps: usize,
}

impl Default for Restarts {
    /// Up to 32 attempts and 1 000 steps together, seed 0, and an end after three that agree on the
    /// same miss.
    fn default() -> Self {
        Self {
            attempts: 32,
            seed: 0,
            agreeing: 3,
            steps: 1000,
        }
    }
}

impl Restarts {
    /// Only the caller's start.
    #[must_use]
    pub fn none() -> Self {
        Self {
            attempts: 1,
            ..Self::default()
        }
    }

    /// At most so many attempts, the caller's start included; at least 1.
    #[must_use]
    pub fn with_attempts(mut self, attempts: usize) -> Self {
        self.attempts = attempts.max(1);
        self
    }

    /// The seed that all random starts come from.
    #[must_use]
    pub fn with_seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// Ends when so many attempts have stopped at the same lowest cost: the target is then taken
    /// to be out of reach. At least 1.
    #[must_use]
    pub fn with_agreeing(mut self, agreeing: usize) -> Self {
        self.agreeing = agreeing.max(1);
        self
    }

    /// After so many steps of all attempts together only one further attempt is made: from where the
    /// best one stands, if that was cut off.
    #[must_use]
    pub fn with_steps(mut self, steps: usize) -> Self {
        self.steps = steps;
        self
    }

    /// The runs, in order; `patient` ones all go to their ends.
    pub(super) fn trials(&self, patient: bool) -> impl Iterator<Item = Trial> + use<> {
        let quick = match self.attempts {
            1 => 0,
            _ if patient => 0,
            attempts => attempts.min(QUICK_ATTEMPTS),
        };
        let finish = (quick > 0).then_some(Trial::FinishBest);
        let last = [Trial::FinishAtLast];
        (0..quick)
            .map(Trial::Quick)
            .chain(finish)
            .chain((quick..self.attempts).map(Trial::Full))
            .chain(last)
    }

    /// How long a quick attempt waits for progress, in steps.
    pub(super) fn patience(index: usize) -> usize {
        if index == 0 {
            PATIENCE_AT_START
        } else {
            PATIENCE
        }
    }

    /// Writes where attempt `index` starts. Odd attempts nudge the caller's start towards a random
    /// place, even ones go there. The first attempts after the start leave what is not free to
    /// `wander` where it is, and all leave alone what no task feels.
    pub(crate) fn start_of(
        &self,
        index: usize,
        start: &[f64],
        wander: &[bool],
        problem: &Problem,
        x: &mut [f64],
    ) {
        x.copy_from_slice(start);
        if index == 0 {
            return;
        }
        let mut random = RandomStream::new(self.seed, index as u64);
        let share = if index % 2 == 1 { NUDGE } else { 1.0 };
        for (j, value) in x.iter_mut().enumerate() {
            let (low, high) = problem.sampling_range(j, start[j]);
            let drawn = low + (high - low) * random.unit();
            if wander[j] || (index > LOCAL_ATTEMPTS && problem.is_felt(j)) {
                *value = start[j] + share * (drawn - start[j]);
            }
        }
    }
}
