//! Numbered attempts: where each one starts, and which one counts.
//!
//! Attempt 0 is the caller's start. Attempts give up as soon as they stall, because another start most
//! often does better than patience; if none arrives, the best of them is finished, and the caller's
//! own, which stays where it comes to nearly the same. So a miss costs a few times what one attempt
//! costs that runs to its end.
//!
//! Attempt i > 0 is drawn from (seed, i) alone, so attempts could
//! run in any order; the lowest index that succeeds wins.

use crate::problem::Question;
use crate::random::RandomStream;

/// How far a nudged start moves towards a random one. Rest poses of rigs are singular: with a bend
/// of 0 both twists coincide, and a small move away shows the way.
const NUDGE: f64 = 0.15;

/// Steps without halving the cost after which an attempt gives up. The caller's start is most often a
/// neighbour of the answer, which is then found at once, or a singular rest pose, which leads nowhere.
/// After ten slow steps a search takes its curvature from differences, which is what it waits for where
/// others will run to their ends, and saves where all give up.
const PATIENCE_AT_START: usize = 6;
const PATIENCE: usize = 9;
const PATIENCE_BEFORE_AGREEING: usize = 10;

/// After so many attempts that gave up the best of them is finished for the first time: it often reaches
/// what only takes long, as where limbs are stretched.
const QUICK_BEFORE_BEST: usize = 8;
/// Where attempts run to their ends anyway, so many that agree end the search.
const AGREEING: usize = 3;

/// How many attempts after the first leave alone what already is where it should be.
const LOCAL_ATTEMPTS: usize = 2;

/// One run of the method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Trial {
    /// An attempt that gives up when it stalls.
    Quick(usize),
    /// The best attempt so far goes on to its end, if it gave up when it stalled.
    FinishBest,
    /// The caller's own attempt does, if another is the best.
    FinishFirst,
    /// An attempt that runs to its end.
    Full(usize),
    /// When attempts agree or the steps are used up, the best of all goes on, unless it came to its
    /// end.
    FinishAtLast,
}

impl Trial {
    /// Whether the trial's end says something of its own about what can be reached: nudged starts
    /// fall into the hole that the start is in.
    pub(super) fn counts_for_agreement(self) -> bool {
        match self {
            Self::Quick(index) | Self::Full(index) => index % 2 == 0,
            Self::FinishBest | Self::FinishFirst | Self::FinishAtLast => true,
        }
    }

    /// Whether the trial still makes sense once no further attempt is made.
    pub(super) fn finishes(self) -> bool {
        !matches!(self, Self::Quick(_) | Self::Full(_))
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
    pub(super) agreeing: Option<usize>,
    pub(crate) steps: usize,
}

impl Default for Restarts {
    /// Up to 32 attempts, all of which are made where none reaches, seed 0, and any number of steps.
    fn default() -> Self {
        Self {
            attempts: 32,
            seed: 0,
            agreeing: None,
            steps: usize::MAX,
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

    /// Ends when so many attempts have stopped at the same lowest cost: the target is then most
    /// likely out of reach. At least 1. All attempts but the first eight then run to their ends, so a
    /// miss costs more and is a little nearer. Unset, this is so only where a problem has preferences,
    /// and three are enough.
    #[must_use]
    pub fn with_agreeing(mut self, agreeing: usize) -> Self {
        self.agreeing = Some(agreeing.max(1));
        self
    }

    /// After so many steps of all attempts together only one further attempt is made: from where the
    /// best one stands, if that was cut off.
    #[must_use]
    pub fn with_steps(mut self, steps: usize) -> Self {
        self.steps = steps;
        self
    }

    /// How many attempts that agree end the search; `patient` ones go to their ends.
    pub(crate) fn enough(&self, patient: bool) -> usize {
        let unset = if patient { AGREEING } else { usize::MAX };
        self.agreeing.unwrap_or(unset)
    }

    /// The runs, in order; `patient` ones all go to their ends.
    pub(super) fn trials(&self, patient: bool) -> impl Iterator<Item = Trial> + use<> {
        let quick = match self.attempts {
            1 => 0,
            _ if patient => 0,
            attempts => attempts.min(QUICK_BEFORE_BEST),
        };
        // Only attempts that came to their ends can agree.
        let later = match quick > 0 && self.agreeing.is_none() {
            true => Trial::Quick,
            false => Trial::Full,
        };
        let best = (quick > 0).then_some(Trial::FinishBest);
        let first = (quick > 0 && self.agreeing.is_none()).then_some(Trial::FinishFirst);
        (0..quick)
            .map(Trial::Quick)
            .chain(best)
            .chain((quick..self.attempts).map(later))
            .chain(best)
            .chain(first)
            .chain([Trial::FinishAtLast])
    }

    /// How long a quick attempt waits for progress, in steps.
    pub(super) fn patience(&self, index: usize) -> usize {
        match self.agreeing {
            _ if index == 0 => PATIENCE_AT_START,
            None => PATIENCE,
            Some(_) => PATIENCE_BEFORE_AGREEING,
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
        question: Question<'_>,
        x: &mut [f64],
    ) {
        x.copy_from_slice(start);
        if index == 0 {
            return;
        }
        let mut random = RandomStream::new(self.seed, index as u64);
        let share = if index % 2 == 1 { NUDGE } else { 1.0 };
        for (j, value) in x.iter_mut().enumerate() {
            let (low, high) = question.sampling_range(j, start[j]);
            let drawn = low + (high - low) * random.unit();
            if wander[j] || (index > LOCAL_ATTEMPTS && question.problem.is_felt(j)) {
                *value = start[j] + share * (drawn - start[j]);
            }
        }
    }
}
