//! Basin hopping: attempts that start at the end of an earlier one, with half of the joints sampled again.
//!
//! Several limbs on a free base must each be on the right branch, which uniform samples rarely achieve at once. An end
//! of low cost has some of the limbs right, and a hop often keeps these.
//!
//! The method is iterated local search (Lourenço, Martin & Stützle 2003, "Iterated local search").

use super::search_result::SearchResult;
use crate::problem::ProblemInstance;
use kinopt_kinematics::random::RandomStream;

/// Number of first attempts without hops, from starts near the caller's start or anywhere. Most problems need no more.
const ATTEMPTS_BEFORE_HOPS: usize = 8;

/// Largest number of hops without a lower cost; the next attempt then starts anywhere.
const MAX_FAILED_HOPS: usize = 12;

/// Fraction of the joints that a hop samples again.
const RESAMPLED_FRACTION: f64 = 0.5;

/// Start of the hops: the end of lowest cost.
#[derive(Clone, Debug, Default)]
pub(super) struct Hops {
    x: Vec<f64>,
    cost: f64,
    failed: usize,
}

impl Hops {
    /// Resizes the memory.
    pub(super) fn fit(&mut self, variables: usize) {
        self.x.resize(variables, 0.0);
    }

    /// Starts a search, or starts hops from another configuration.
    pub(super) fn begin(&mut self) {
        (self.cost, self.failed) = (f64::INFINITY, 0);
    }

    /// Writes the start of attempt `index` and returns true if the attempt is a hop.
    pub(super) fn start_of(
        &mut self,
        index: usize,
        seed: u64,
        instance: ProblemInstance<'_>,
        x: &mut [f64],
    ) -> bool {
        if index < ATTEMPTS_BEFORE_HOPS || self.cost == f64::INFINITY {
            return false;
        }
        if self.failed >= MAX_FAILED_HOPS {
            self.begin();
            return false;
        }
        let mut random = RandomStream::new(seed, index as u64);
        x.copy_from_slice(&self.x);
        for (j, value) in x.iter_mut().enumerate() {
            let (low, high) = instance.sampling_range(j, *value);
            let (is_resampled, fraction) = (random.unit() < RESAMPLED_FRACTION, random.unit());
            let problem = instance.problem;
            if is_resampled && problem.moves_a_task(j) && !problem.is_base_variable(j) {
                *value = low + (high - low) * fraction;
            }
        }
        true
    }

    /// Takes the end of an attempt.
    pub(super) fn record(&mut self, attempt: &SearchResult, x: &[f64]) {
        match attempt.cost < self.cost {
            true => {
                self.x.copy_from_slice(x);
                (self.cost, self.failed) = (attempt.cost, 0);
            }
            false => self.failed += 1,
        }
    }
}
