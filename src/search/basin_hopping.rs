//! Attempts that begin where an earlier one ended, with half of the joints drawn anew.
//!
//! Two hands and two feet of a body on a free base must each be on the right branch, and chance alone would have
//! to find all of them at once. An end that is low has some of them right, and about as many hops keep those as
//! there are limbs. So where all starts are drawn alike a fifth to a half of the attempts is lost (iterated local
//! search, Lourenço, Martin & Stützle 2003, "Iterated local search").

use super::attempt::Attempt;
use crate::problem::Question;
use crate::random::RandomStream;

/// The first attempts begin beside the caller's start or anywhere: most bodies need no others.
const FIRST: usize = 8;

/// After so many hops from a place that did not lead lower, the next attempt begins anywhere.
const PATIENCE: usize = 12;

/// The share of the joints that a hop draws anew.
const DRAWN: f64 = 0.5;

/// Where hops begin.
#[derive(Clone, Debug, Default)]
pub(super) struct Hops {
    x: Vec<f64>,
    cost: f64,
    failed: usize,
}

impl Hops {
    /// Makes room.
    pub(super) fn fit(&mut self, variables: usize) {
        self.x.resize(variables, 0.0);
    }

    /// Forgets the last search.
    pub(super) fn begin(&mut self) {
        (self.cost, self.failed) = (f64::INFINITY, 0);
    }

    /// Writes where attempt `index` begins, if it is a hop.
    pub(super) fn start_of(
        &mut self,
        index: usize,
        seed: u64,
        question: Question<'_>,
        x: &mut [f64],
    ) -> bool {
        if index < FIRST || self.cost == f64::INFINITY {
            return false;
        }
        if self.failed >= PATIENCE {
            self.begin();
            return false;
        }
        let mut random = RandomStream::new(seed, index as u64);
        x.copy_from_slice(&self.x);
        for (j, value) in x.iter_mut().enumerate() {
            let (low, high) = question.sampling_range(j, *value);
            let (chosen, share) = (random.unit() < DRAWN, random.unit());
            let problem = question.problem;
            if chosen && problem.moves_a_task(j) && !problem.floats(j) {
                *value = low + (high - low) * share;
            }
        }
        true
    }

    /// Takes where an attempt ended.
    pub(super) fn take(&mut self, attempt: &Attempt, x: &[f64]) {
        match attempt.cost < self.cost {
            true => {
                self.x.copy_from_slice(x);
                (self.cost, self.failed) = (attempt.cost, 0);
            }
            false => self.failed += 1,
        }
    }
}
