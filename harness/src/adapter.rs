//! What a solver must do to be compared.

use std::time::{Duration, Instant};

use kinopt::ik::Solution;
use kinopt::problem::{self, Derivatives};
use kinopt::solver::Counts;
use kinopt::spatial::Placement;

use crate::{Budget, ProblemSet, Trace};

/// A solver under test. Only [`name`](Self::name) and [`solve`](Self::solve) must be written.
pub trait Adapter {
    /// Its name in tables and pictures; unique within a bench.
    fn name(&self) -> &str;

    /// Where it comes from: solvers of a family share a panel in pictures.
    fn family(&self) -> &str {
        "others"
    }

    /// What a reader should know about how it was set up: limits of one attempt, options.
    fn setting(&self) -> String {
        String::new()
    }

    /// The derivative routes that change how it works; it runs once by each. A solver that takes no
    /// derivatives from the problem runs once, by none.
    fn routes(&self) -> &[Derivatives] {
        &[]
    }

    /// Prepares for a problem set and a budget, outside all timing.
    ///
    /// # Errors
    /// Why the solver cannot take part, in a few words; it then sits out and the results say so.
    fn prepare(&mut self, set: &ProblemSet, budget: Budget) -> Result<(), String> {
        let _ = (set, budget);
        Ok(())
    }

    /// Solves one problem within the budget. `trace` takes marks of the way there
    /// ([`Trace::mark`]); a solver that marks nothing has the time of its end for every accuracy.
    fn solve(&mut self, question: &Question<'_>, trace: &Trace) -> Answer;
}

/// One problem, as every solver sees it.
#[derive(Clone, Copy, Debug)]
pub struct Question<'a> {
    /// The model, the frames and the tolerances.
    pub set: &'a ProblemSet,
    /// The problem with its targets in place and the derivative route chosen.
    pub problem: problem::Question<'a>,
    /// world_from_target of each frame of the set.
    pub targets: &'a [Placement<f64>],
    /// Where to start: a configuration within the limits.
    pub start: &'a [f64],
    /// What may be spent.
    pub budget: Budget,
    /// A seed for whatever is random: one for each case, the same for every solver.
    pub seed: u64,
}

impl Question<'_> {
    /// Where attempt `index` starts: 0 is the case's own start, the others are random configurations
    /// within the limits, the same for every solver.
    #[must_use]
    pub fn start_of_attempt(&self, index: usize) -> Vec<f64> {
        match u64::try_from(index) {
            Ok(0) => self.start.to_vec(),
            index => self
                .set
                .random_configuration(self.seed ^ index.unwrap_or(u64::MAX)),
        }
    }

    /// A cost below which every target is within the tolerances.
    #[must_use]
    pub fn sufficient_cost(&self) -> f64 {
        let weighted = self
            .set
            .length_tolerance()
            .min(self.set.weighted_angle_tolerance());
        0.5 * weighted * weighted
    }
}

/// What a solver answers.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// The configuration (shape: the model's degrees of freedom).
    pub q: Vec<f64>,
    /// Whether the solver thinks that it has solved the problem. It ends [`attempts`]; the verdict
    /// is the harness' own.
    pub reached: bool,
    /// ½ Σ‖W r‖² at `q` as the solver knows it; infinity where it does not. It chooses among
    /// [`attempts`].
    pub cost: f64,
    /// Steps of all attempts together.
    pub iterations: usize,
    /// Attempts made.
    pub attempts: usize,
    /// Evaluations of all attempts together.
    pub counts: Counts,
}

impl Answer {
    /// A configuration about which nothing else is known.
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

/// Tries again from random starts while a local solver misses, as the budget allows: the restarts
/// of every solver that has none of its own. `attempt` gets the start, its number, and the time that
/// is left. The attempt that reaches, or else the one with the lowest cost, is the answer.
pub fn attempts(
    question: &Question<'_>,
    mut attempt: impl FnMut(&[f64], usize, Duration) -> Answer,
) -> Answer {
    let begun = Instant::now();
    let mut left = question.budget.time_limit;
    let mut best = attempt(question.start, 0, left);
    for index in 1..question.budget.attempts {
        left = question.budget.time_limit.saturating_sub(begun.elapsed());
        if best.reached || left.is_zero() {
            break;
        }
        let mut next = attempt(&question.start_of_attempt(index), index, left);
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
