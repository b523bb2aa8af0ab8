//! What attempts came to.

use super::Solution;
use crate::solver::{Counts, Termination};

/// What one attempt came to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Attempt {
    pub(crate) termination: Termination,
    pub(crate) cost: f64,
    pub(crate) reached: bool,
    pub(crate) iterations: usize,
    pub(crate) counts: Counts,
    pub(crate) projected_gradient: Option<f64>,
}

/// What several attempts came to, by the one that counts; where, is in the [`Keeper`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Found {
    pub(crate) termination: Termination,
    /// The last attempt that it took, from 0.
    pub(crate) number: usize,
    pub(crate) cost: f64,
    pub(crate) reached: bool,
    pub(crate) projected_gradient: Option<f64>,
    /// Of all attempts together.
    pub(crate) iterations: usize,
    pub(crate) attempts: usize,
    pub(crate) counts: Counts,
    /// How many attempts stopped as near as the one that counts, itself included.
    pub(crate) agreeing: usize,
}

impl Default for Found {
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

impl Found {
    /// Takes further attempts into account; whether one of those counts from now on.
    pub(crate) fn go_on_with(&mut self, more: &Self) -> bool {
        let better = more.reached || self.attempts == 0 || more.cost < self.cost;
        let all = (
            self.iterations + more.iterations,
            self.attempts + more.attempts,
        );
        if better {
            let number = self.attempts + more.number;
            *self = Self { number, ..*more };
        }
        (self.iterations, self.attempts) = all;
        better
    }

    /// Returns to the attempt that counted earlier; all that were made are counted still.
    pub(crate) fn fall_back_to(&mut self, earlier: &Self) {
        *self = Self {
            iterations: self.iterations,
            attempts: self.attempts,
            ..*earlier
        };
    }
}

impl Found {
    /// What a solution says of the attempts that led to it.
    pub(crate) fn of(solution: &Solution) -> Self {
        let mut found = Self::default();
        found.add(solution);
        found
    }

    /// Takes further searches for the same into account, by what the last one came to.
    pub(crate) fn add(&mut self, solution: &Solution) {
        self.termination = solution.termination;
        self.projected_gradient = solution.projected_gradient;
        self.agreeing = 0;
        self.iterations += solution.iterations;
        self.attempts += solution.attempts;
        self.counts += solution.counts;
    }

    /// The same attempts, the last of which went on in a search for what else is wanted.
    pub(crate) fn refined_by(mut self, solution: &Solution) -> Self {
        let attempts = self.attempts;
        self.add(solution);
        self.attempts = attempts;
        self
    }

    /// A lone attempt, whose end is not judged yet.
    pub(crate) fn alone(termination: Termination, iterations: usize) -> Self {
        Self {
            termination,
            iterations,
            attempts: 1,
            ..Self::default()
        }
    }
}
