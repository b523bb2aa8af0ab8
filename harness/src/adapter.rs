//! Interface of a solver under test.

use std::time::{Duration, Instant};

use kinopt::ik::Solution;
use kinopt::problem::{self, Derivatives};
use kinopt::solver::Counts;
use kinopt::spatial::Placement;

use crate::{Budget, ProblemSet, Trace};

/// A solver under test. Only [`name`](Self::name) and [`solve`](Self::solve) are required.
pub trait Adapter {
    /// Name in tables and pictures; unique within a bench.
    fn name(&self) -> &str;

    /// Family: solvers of one family share a panel in pictures.
    fn family(&self) -> &str {
        "others"
    }

    /// Settings for the report: limits of one attempt, options.
    fn setting(&self) -> String {
        String::new()
    }

    /// Derivative modes that affect it; it runs once for each. A solver without derivatives of the problem runs once.
    fn routes(&self) -> &[Derivatives] {
        &[]
    }

    /// Prepares for a problem set and a budget; not timed.
    ///
    /// # Errors
    /// Returns a short reason if the solver does not support the problem set. The results report it.
    fn prepare(&mut self, set: &ProblemSet, budget: Budget) -> Result<(), String> {
        let _ = (set, budget);
        Ok(())
    }

    /// Solves one problem within the budget. `trace` receives intermediate configurations ([`Trace::mark`]). A solver
    /// without marks has its total time for every accuracy.
    fn solve(&mut self, instance: &ProblemInstance<'_>, trace: &Trace) -> Answer;
}

/// One problem, equal for all solvers.
#[derive(Clone, Copy, Debug)]
pub struct ProblemInstance<'a> {
    /// Model, frames and tolerances.
    pub set: &'a ProblemSet,
    /// Problem with its targets and derivative mode.
    pub problem: problem::ProblemInstance<'a>,
    /// world_from_target of each frame of the set.
    pub targets: &'a [Placement<f64>],
    /// Start configuration, within the limits.
    pub start: &'a [f64],
    /// Budget of the solve.
    pub budget: Budget,
    /// Seed for random numbers: one for each case, equal for all solvers.
    pub seed: u64,
}

impl ProblemInstance<'_> {
    /// Start of attempt `index`: 0 is the start of the case, the others are random configurations within the limits,
    /// equal for all solvers.
    #[must_use]
    pub fn start_of_attempt(&self, index: usize) -> Vec<f64> {
        match u64::try_from(index) {
            Ok(0) => self.start.to_vec(),
            index => self
                .set
                .random_configuration(self.seed ^ index.unwrap_or(u64::MAX)),
        }
    }

    /// Cost below which every target is within the tolerances.
    #[must_use]
    pub fn sufficient_cost(&self) -> f64 {
        let weighted = self
            .set
            .length_tolerance()
            .min(self.set.weighted_angle_tolerance());
        0.5 * weighted * weighted
    }
}

/// Result of a solver.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// Configuration (shape: the model's degrees of freedom).
    pub q: Vec<f64>,
    /// True if the solver considers the problem solved. It ends [`attempts`]; the judge of the harness decides.
    pub reached: bool,
    /// ½ Σ‖W r‖² at `q` according to the solver; infinity if unknown. [`attempts`] selects by it.
    pub cost: f64,
    /// Iterations of all attempts together.
    pub iterations: usize,
    /// Number of attempts.
    pub attempts: usize,
    /// Evaluations of all attempts together.
    pub counts: Counts,
}

impl Answer {
    /// Result with a configuration only.
    #[must_use]
    pub fn at(q: Vec<f64>) -> Self {
        Self {
            q,
            reached: false,
            cost: f64::INFINITY,
            iterations: 0,
            attempts: 1,
            counts: Counts::default(),
        }
    }
}

impl From<&Solution> for Answer {
    fn from(solution: &Solution) -> Self {
        Self {
            q: solution.q.clone(),
            reached: solution.reached,
            cost: solution.cost,
            iterations: solution.iterations,
            attempts: solution.attempts,
            counts: solution.counts,
        }
    }
}

/// Restarts a local solver from random starts after a miss, within the budget: for solvers without restarts of their
/// own. `attempt` receives the start, the index of the attempt, and the remaining time. Returns the attempt that
/// reaches, else the one with the lowest cost.
pub fn attempts(
    instance: &ProblemInstance<'_>,
    mut attempt: impl FnMut(&[f64], usize, Duration) -> Answer,
) -> Answer {
    let started = Instant::now();
    let mut remaining = instance.budget.time_limit;
    let mut best = attempt(instance.start, 0, remaining);
    for index in 1..instance.budget.attempts {
        remaining = instance.budget.time_limit.saturating_sub(started.elapsed());
        if best.reached || remaining.is_zero() {
            break;
        }
        let mut next = attempt(&instance.start_of_attempt(index), index, remaining);
        next.iterations += best.iterations;
        next.attempts += best.attempts;
        next.counts += best.counts;
        if next.reached || next.cost < best.cost {
            best = next;
        } else {
            best = Answer {
                q: best.q,
                reached: best.reached,
                cost: best.cost,
                ..next
            };
        }
    }
    best
}
