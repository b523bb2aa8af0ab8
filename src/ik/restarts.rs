//! Numbered attempts: where each one starts, and which one counts.
//!
//! Attempt 0 is the caller's start. Attempt i > 0 is drawn from (seed, i) alone, so attempts could
//! run in any order; the lowest index that succeeds wins.

use crate::random::RandomStream;

/// How far a nudged start moves towards a random one. Rest poses of rigs are singular: with a bend
/// of 0 both twists coincide, and a small move away shows the way.
const NUDGE: f64 = 0.15;

/// How often to try again, and from where.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Restarts {
    pub(super) attempts: usize,
    pub(super) seed: u64,
    pub(super) agreeing: usize,
}

impl Default for Restarts {
    /// Up to 32 attempts, seed 0, and an end after three that agree on the same miss.
    fn default() -> Self {
        Self {
            attempts: 32,
            seed: 0,
            agreeing: 3,
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

    /// Writes where attempt `index` starts. Odd attempts nudge the caller's start towards a random
    /// place, even ones go there. Unbounded variables are drawn within `spread` of the start.
    pub(super) fn start_of(
        &self,
        index: usize,
        start: &[f64],
        lower: &[f64],
        upper: &[f64],
        spread: &[f64],
        x: &mut [f64],
    ) {
        if index == 0 {
            x.copy_from_slice(start);
            return;
        }
        let mut random = RandomStream::new(self.seed, index as u64);
        let share = if index % 2 == 1 { NUDGE } else { 1.0 };
        for (j, value) in x.iter_mut().enumerate() {
            let low = lower[j].max(start[j] - 2.0 * spread[j]);
            let high = upper[j].min(start[j] + 2.0 * spread[j]);
            let (low, high) = if lower[j].is_finite() && upper[j].is_finite() {
                (lower[j], upper[j])
            } else {
                (low, high)
            };
            let drawn = low + (high - low) * random.unit();
            *value = start[j] + share * (drawn - start[j]);
        }
    }
}
