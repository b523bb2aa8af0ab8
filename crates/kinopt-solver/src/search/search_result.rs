//! Result of a search.

use super::Solution;
use crate::solver::{Counts, Termination};

/// Result of one or more attempts: that of the best attempt, with totals. The search's state holds its configuration.
#[derive(Clone, Copy, Debug)]
#[doc(hidden)]
pub struct SearchResult {
    #[doc(hidden)]
    pub termination: Termination,
    /// Index of the latest attempt when this result was taken, from 0.
    #[doc(hidden)]
    pub number: usize,
    #[doc(hidden)]
    pub cost: f64,
    #[doc(hidden)]
    pub reached: bool,
    #[doc(hidden)]
    pub projected_gradient: Option<f64>,
    /// Total over all attempts.
    #[doc(hidden)]
    pub iterations: usize,
    #[doc(hidden)]
    pub attempts: usize,
    #[doc(hidden)]
    pub counts: Counts,
    /// Number of attempts whose cost agrees with that of the best one, which is included.
    #[doc(hidden)]
    pub agreeing: usize,
}

impl Default for SearchResult {
    /// No attempt.
    fn default() -> Self {
        Self {
            termination: Termination::NonFinite,
            number: 0,
            cost: f64::INFINITY,
            reached: false,
            projected_gradient: None,
            iterations: 0,
            attempts: 0,
            counts: Counts::default(),
            agreeing: 0,
        }
    }
}

impl SearchResult {
    /// Adds the result of a later search; returns whether its best attempt is the new best one.
    #[doc(hidden)]
    pub fn merge_later(&mut self, later: &Self) -> bool {
        let is_better = later.reached || self.attempts == 0 || later.cost < self.cost;
        let totals = (
            self.iterations + later.iterations,
            self.attempts + later.attempts,
        );
        if is_better {
            let number = self.attempts + later.number;
            *self = Self { number, ..*later };
        }
        (self.iterations, self.attempts) = totals;
        is_better
    }

    /// Restores an earlier best attempt; iterations and attempts keep their totals.
    #[doc(hidden)]
    pub fn restore_best(&mut self, earlier: &Self) {
        *self = Self {
            iterations: self.iterations,
            attempts: self.attempts,
            ..*earlier
        };
    }
}

impl SearchResult {
    /// The result of the search that led to a solution.
    pub(crate) fn of(solution: &Solution) -> Self {
        let mut result = Self::default();
        result.add(solution);
        result
    }

    /// Adds the totals of a further search for one solution, and takes its termination.
    pub(crate) fn add(&mut self, solution: &Solution) {
        self.termination = solution.termination;
        self.projected_gradient = solution.projected_gradient;
        self.agreeing = 0;
        self.iterations += solution.iterations;
        self.attempts += solution.attempts;
        self.counts += solution.counts;
    }

    /// Adds a search that refined the last attempt; the number of attempts does not change.
    pub(crate) fn refined_by(mut self, solution: &Solution) -> Self {
        let attempts = self.attempts;
        self.add(solution);
        self.attempts = attempts;
        self
    }

    /// A single attempt without a cost yet.
    #[doc(hidden)]
    pub fn single_attempt(termination: Termination, iterations: usize) -> Self {
        Self {
            termination,
            iterations,
            attempts: 1,
            ..Self::default()
        }
    }
}
