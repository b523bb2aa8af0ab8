//! Numbered attempts: how many, and where each one starts.
//!
//! Attempt 0 is the caller's start. Attempt i > 0 is drawn from (seed, i) alone, so attempts could
//! run in any order; the lowest index that succeeds wins. Later attempts of a body on a free base
//! begin where an earlier one ended: see `hops.rs`.

use crate::bad_option::{AT_LEAST_ONE, BadOption};
use crate::problem::{Question, Share};
use crate::random::RandomStream;

/// How far a nudged start moves towards a random one. Rest poses of rigs are singular: with a bend
/// of 0 both twists coincide, and a small move away shows the way.
const NUDGE: f64 = 0.15;

/// How many attempts after the first leave alone what already is where it should be.
const LOCAL_ATTEMPTS: usize = 2;

/// Attempts where no number is given.
const USUAL: usize = 32;
/// For a body on a free base that has fewer than so many variables more than its goals have rows: there are few
/// solutions, each behind a branch of every limb.
const TIGHT: usize = 4;
const USUAL_WHERE_TIGHT: usize = 512;

/// Every so many attempts a free base, too, goes anywhere; in the others it is nudged.
const FAR_BASE_EVERY: usize = 4;

/// Number of attempts, and the seed of their starts.
///
/// The first attempt is from the caller's start. If every goal is within 1 rad of the start, lengths divided by a quarter of the
/// model's reach, it runs to its end before others are made: a solution that it reaches is the one that is returned. For goals
/// farther away it gives up when it stalls, and others are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Restarts {
    /// Unset, as many as the question wants.
    attempts: Option<usize>,
    pub(super) seed: u64,
    pub(super) agreeing: Option<usize>,
    pub(super) steps: usize,
}

impl Default for Restarts {
    /// Up to 32 attempts, all of which are made where none reaches, seed 0, and any number of steps; up to 512 for
    /// a body on a free base whose variables outnumber its goals' rows by less than four (both feet and both hands
    /// of a robot with short arms, say).
    fn default() -> Self {
        Self {
            attempts: None,
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
            attempts: Some(1),
            ..Self::default()
        }
    }

    setters! {
        /// At most so many attempts, the caller's start included; at least 1.
        pub fn with_attempts(mut self, attempts: usize) { self.attempts = Some(attempts) }
        /// The seed that all random starts come from.
        pub fn with_seed(mut self, seed: u64) { self.seed = seed }
        /// Ends when so many attempts have stopped within a thousandth of the lowest cost: the target is then most
        /// likely out of reach. At least 1. All attempts but the first eight then run to their ends, so a
        /// miss costs more and is a little nearer. Unset, this is so only where a problem has preferences,
        /// and three are enough.
        pub fn with_agreeing(mut self, agreeing: usize) { self.agreeing = Some(agreeing) }
        /// After so many steps of all attempts together only one further attempt is made: from where the
        /// best one stands, if that was cut off.
        pub fn with_steps(mut self, steps: usize) { self.steps = steps }
    }

    /// Whether both numbers of attempts are in their ranges.
    pub(crate) fn check(&self) -> Result<(), BadOption> {
        let agreeing = self.agreeing.unwrap_or(1);
        let attempts = self.attempts.unwrap_or(USUAL);
        BadOption::check("attempts", attempts as f64, AT_LEAST_ONE)?;
        BadOption::check("agreeing", agreeing as f64, AT_LEAST_ONE)
    }

    /// How many attempts a question gets.
    pub(super) fn attempts_for(&self, question: Question<'_>, share: Share) -> usize {
        self.attempts.unwrap_or_else(|| {
            let problem = question.problem;
            let room = problem.rows_of(share) + TIGHT;
            match problem.has_free_joint() && problem.variables() < room {
                true => USUAL_WHERE_TIGHT,
                false => USUAL,
            }
        })
    }

    /// Writes where attempt `index` starts. Odd attempts nudge the caller's start towards a random
    /// place, even ones go there. The first attempts after the start leave what is not
    /// `local` where it is, and all leave alone what moves no task.
    pub(super) fn start_of(
        &self,
        index: usize,
        start: &[f64],
        local: &[bool],
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
            // What a body stands on most often says more of where it can be than chance does.
            let share = match question.problem.floats(j) && !index.is_multiple_of(FAR_BASE_EVERY) {
                true => NUDGE * share,
                false => share,
            };
            if local[j] || (index > LOCAL_ATTEMPTS && question.problem.moves_a_task(j)) {
                *value = start[j] + share * (drawn - start[j]);
            }
        }
    }
}
