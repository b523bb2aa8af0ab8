//! The loop that the geometric methods share: sweep, look, stop; try again from elsewhere; report.

use std::time::Instant;

use super::GeometricError;
use super::report::{Best, report};
use crate::ik::{Restarts, Solution, check_start};
use crate::problem::{Evaluation, Question, Scratch, Share};
use crate::solver::{
    Counts, Iteration, LeastSquares, Observer, Stopping, Termination, half_squared, project,
};

/// Costs within this share of each other count as the same miss.
const SAME_COST: f64 = 1e-6;
/// A sweep that lowers the cost by no more than this share has hardly changed it, …
const FLAT: f64 = 1e-13;
/// … and after so many in a row no further one makes sense.
const FLAT_SWEEPS: usize = 5;

/// One geometric method at work on one problem.
pub(super) trait Sweep {
    /// Stands at a new start, within the bounds.
    fn begin(&mut self, x: &[f64]);

    /// Whether the start itself may be the answer. A method that promises more than its goals (an
    /// elbow's side) says no.
    fn start_counts(&self) -> bool {
        true
    }

    /// Moves the variables once, from bounds to within bounds.
    fn sweep(&mut self, x: &mut [f64]);
}

/// How long to go on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Limits {
    pub(super) stopping: Stopping,
    pub(super) restarts: Restarts,
}

impl Limits {
    /// Sweeps are cheap and gain little each: more of them than of an optimiser's steps, and an end
    /// where they crawl.
    pub(super) fn usual() -> Self {
        let stopping = Stopping::default().with_max_iterations(500);
        Self {
            stopping: stopping.with_patience(Some(60)),
            restarts: Restarts::default().with_steps(2000),
        }
    }
}

/// All attempts at one problem.
struct Search<'a> {
    question: Question<'a>,
    scratch: Scratch,
    limits: Limits,
    deadline: Option<Instant>,
    counts: Counts,
    iterations: usize,
}

/// Searches from the configuration `start` (projected into the limits).
pub(super) fn solve(
    question: Question<'_>,
    start: &[f64],
    limits: Limits,
    method: &mut dyn Sweep,
    observer: &mut dyn Observer,
) -> Result<Solution, GeometricError> {
    let problem = question.problem;
    check_start(problem, start)?;
    let mut from = vec![0.0; problem.variables()];
    problem.parameters().reduce(start, &mut from);
    project(&mut from, question.lower(), question.upper());
    let mut search = Search {
        question,
        scratch: problem.scratch(),
        limits,
        deadline: limits.stopping.deadline(),
        counts: Counts::default(),
        iterations: 0,
    };
    let (best, termination, attempts) = search.attempts(&from, method, observer);
    let mut solution = report(
        question,
        &mut search.scratch,
        limits.stopping,
        &best,
        termination,
    );
    solution.iterations = search.iterations;
    solution.attempts = attempts;
    solution.counts = search.counts;
    Ok(solution)
}

impl Search<'_> {
    /// Runs the attempts until one reaches the goals, several agree on the same miss, or they run
    /// out. Among equals the earliest, which is the nearest to the caller's start, stays.
    fn attempts(
        &mut self,
        from: &[f64],
        method: &mut dyn Sweep,
        observer: &mut dyn Observer,
    ) -> (Best, Termination, usize) {
        let (question, restarts) = (self.question, self.limits.restarts);
        let problem = question.problem;
        let mut residual = vec![0.0; problem.rows()];
        self.residual(from, &mut residual);
        let mut wander = vec![true; problem.variables()];
        problem.mark_free_to_wander(Share::All, &residual, &mut wander);

        let mut best = Best::default();
        let mut ended = Termination::NonFinite;
        let (mut agreeing, mut attempt) = (0, 0);
        let mut x = from.to_vec();
        loop {
            restarts.start_of(attempt, from, &wander, question, &mut x);
            project(&mut x, question.lower(), question.upper());
            let (found, termination) = self.attempt(&x, method, observer);
            attempt += 1;
            let better =
                attempt == 1 || found.reached || found.cost < best.cost * (1.0 - SAME_COST);
            if matches!(termination, Termination::SmallStep | Termination::Stalled) {
                agreeing = match better {
                    true => 1,
                    false => agreeing + usize::from(found.cost <= best.cost * (1.0 + SAME_COST)),
                };
            }
            if better {
                (best, ended) = (found, termination);
            }
            let over = attempt >= restarts.attempts
                || agreeing >= restarts.enough(true)
                || self.iterations >= restarts.steps;
            let late = || self.deadline.is_some_and(|at| Instant::now() >= at);
            // What ends the search is told, also where an earlier attempt is the one returned.
            let cut = match termination {
                Termination::Cancelled | Termination::TimeLimit => Some(termination),
                _ if !over && late() => Some(Termination::TimeLimit),
                _ => None,
            };
            if best.reached || over || cut.is_some() {
                let ended = cut.filter(|_| !best.reached).unwrap_or(ended);
                return (best, ended, attempt);
            }
        }
    }

    /// Sweeps from one start. What is returned is the best place on the way: not every sweep of
    /// every method lowers the cost.
    fn attempt(
        &mut self,
        start: &[f64],
        method: &mut dyn Sweep,
        observer: &mut dyn Observer,
    ) -> (Best, Termination) {
        let stopping = self.limits.stopping;
        let mut x = start.to_vec();
        let mut previous = x.clone();
        let mut residual = vec![0.0; self.question.problem.rows()];
        let mut best = Best {
            x: x.clone(),
            residual: residual.clone(),
            cost: f64::INFINITY,
            reached: false,
        };
        let (mut step, mut flat, mut milestone) = (0.0, 0, (0, f64::INFINITY));
        method.begin(&x);
        for index in 0.. {
            self.residual(&x, &mut residual);
            let cost = half_squared(&residual);
            if !cost.is_finite() {
                if index == 0 {
                    best.residual.copy_from_slice(&residual);
                    best.cost = cost;
                }
                return (best, Termination::NonFinite);
            }
            let reached = self.question.problem.is_reached(&residual);
            flat = match best.cost - cost > FLAT * cost {
                true => 0,
                false => flat + 1,
            };
            let counts = index > 0 || method.start_counts();
            if counts && (cost < best.cost || (reached && !best.reached)) {
                best.x.copy_from_slice(&x);
                best.residual.copy_from_slice(&residual);
                (best.cost, best.reached) = (cost, reached);
            }
            let seen = observer.observe(&Iteration {
                index,
                cost,
                projected_gradient: None,
                step,
                damping: 0.0,
                x: &x,
            });
            if cost < 0.5 * milestone.1 {
                milestone = (index, cost);
            }
            let waited = index - milestone.0;
            let still = |tolerance: f64| {
                let moves = x.iter().zip(&previous);
                let mut moves = moves.map(|(a, b)| (a - b).abs() - tolerance * a.abs().max(1.0));
                index > 0 && moves.all(|beyond| beyond <= 0.0)
            };
            let end = if best.reached {
                Some(Termination::Reached)
            } else if seen.is_break() {
                Some(Termination::Cancelled)
            } else if still(stopping.step_tolerance()) || flat >= FLAT_SWEEPS {
                Some(Termination::SmallStep)
            } else if stopping
                .patience()
                .is_some_and(|patience| waited >= patience)
            {
                Some(Termination::Stalled)
            } else if index >= stopping.max_iterations() {
                Some(Termination::IterationLimit)
            } else if self
                .deadline
                .is_some_and(|deadline| Instant::now() >= deadline)
            {
                Some(Termination::TimeLimit)
            } else {
                None
            };
            if let Some(end) = end {
                return (best, end);
            }
            previous.copy_from_slice(&x);
            method.sweep(&mut x);
            self.iterations += 1;
            step = largest_move(&x, &previous);
        }
        (best, Termination::IterationLimit)
    }

    fn residual(&mut self, x: &[f64], residual: &mut [f64]) {
        Evaluation::new(self.question, &mut self.scratch).residual(x, residual);
        self.counts.residuals += 1;
    }
}

/// ‖x − previous‖∞.
fn largest_move(x: &[f64], previous: &[f64]) -> f64 {
    let moves = x.iter().zip(previous).map(|(a, b)| (a - b).abs());
    moves.fold(0.0, f64::max)
}
