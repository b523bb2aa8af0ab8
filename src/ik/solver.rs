//! A method with its limits and restarts: what a user calls.

use std::sync::Arc;
use std::time::Instant;

use super::{Restarts, Solution, SolveError, Workspace};
use crate::problem::{Evaluation, Problem};
use crate::solver::{
    Counts, LevenbergMarquardt, Method, Observer, Outcome, Silent, Stopping, Termination,
    minimise_until,
};

/// Costs of attempts within this share of each other count as the same miss.
const SAME_COST: f64 = 1e-6;

/// A solver with its settings. Immutable and shareable; the memory is the caller's
/// [`Workspace`].
#[derive(Clone)]
pub struct Solver {
    method: Arc<dyn Method>,
    stopping: Stopping,
    restarts: Restarts,
}

impl std::fmt::Debug for Solver {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Solver")
            .field("method", &self.method.name())
            .field("stopping", &self.stopping)
            .field("restarts", &self.restarts)
            .finish()
    }
}

impl Default for Solver {
    /// Levenberg-Marquardt with gain-ratio damping and default restarts.
    fn default() -> Self {
        Self::new(LevenbergMarquardt::default())
    }
}

impl Solver {
    /// A solver around any method, with default limits and restarts.
    #[must_use]
    pub fn new(method: impl Method + 'static) -> Self {
        Self {
            method: Arc::new(method),
            stopping: Stopping::default(),
            restarts: Restarts::default(),
        }
    }

    /// Sets the limits of each attempt; the time limit is for all of them together.
    #[must_use]
    pub fn with_stopping(mut self, stopping: Stopping) -> Self {
        self.stopping = stopping;
        self
    }

    /// Sets how often to try again.
    #[must_use]
    pub fn with_restarts(mut self, restarts: Restarts) -> Self {
        self.restarts = restarts;
        self
    }

    /// The method's name.
    #[must_use]
    pub fn method(&self) -> &'static str {
        self.method.name()
    }

    /// Solves `problem` from the configuration `start` (degrees of freedom; projected into the
    /// limits; locked and following joints take their values from the parameter map).
    ///
    /// # Errors
    /// A start of the wrong length, or one that is not finite. A target that is not reached is no
    /// error: see [`Solution::reached`] and [`Solution::explain`].
    pub fn solve<'w>(
        &self,
        problem: &Problem,
        start: &[f64],
        workspace: &'w mut Workspace,
    ) -> Result<&'w Solution, SolveError> {
        self.solve_observed(problem, start, workspace, &mut Silent)
    }

    /// As [`solve`](Self::solve), with memory of its own that is thrown away.
    ///
    /// # Errors
    /// As [`solve`](Self::solve).
    pub fn solve_once(&self, problem: &Problem, start: &[f64]) -> Result<Solution, SolveError> {
        let mut workspace = Workspace::new();
        self.solve(problem, start, &mut workspace)?;
        Ok(workspace.solution)
    }

    /// As [`solve`](Self::solve), with an observer that sees every iteration of every attempt and
    /// may cancel. Iterations count from 0 in each attempt.
    ///
    /// # Errors
    /// As [`solve`](Self::solve).
    pub fn solve_observed<'w>(
        &self,
        problem: &Problem,
        start: &[f64],
        workspace: &'w mut Workspace,
        observer: &mut dyn Observer,
    ) -> Result<&'w Solution, SolveError> {
        check_start(problem, start)?;
        workspace.fit(problem);
        let deadline = self.stopping.deadline();
        let Workspace {
            memory,
            scratch,
            start: start_x,
            attempt,
            best_x,
            best_residual,
            solution,
        } = workspace;
        let Some((_, scratch)) = scratch else {
            return Ok(solution);
        };
        problem.parameters().reduce(start, start_x);
        crate::solver::project(start_x, problem.lower(), problem.upper());

        let mut best: Option<(Outcome, f64)> = None;
        let (mut iterations, mut attempts, mut agreeing) = (0, 0, 0);
        let mut counts = Counts::default();
        for index in 0..self.restarts.attempts {
            self.restarts.start_of(
                index,
                start_x,
                problem.lower(),
                problem.upper(),
                problem.spread(),
                attempt,
            );
            let mut evaluation = Evaluation::new(problem, scratch);
            let outcome = minimise_until(
                &mut evaluation,
                &*self.method,
                attempt,
                &self.stopping,
                deadline,
                observer,
                memory,
            );
            attempts += 1;
            iterations += outcome.iterations;
            counts += memory.counts();

            let cost = memory.cost();
            let reached = problem.is_reached(memory.residual());
            let finite = best.map(|(_, cost)| cost).filter(|cost| !cost.is_nan());
            let lowest = finite.unwrap_or(f64::INFINITY);
            agreeing = match settled(outcome.termination) {
                true if cost < lowest * (1.0 - SAME_COST) => 1,
                true if cost <= lowest * (1.0 + SAME_COST) => agreeing + 1,
                _ => agreeing,
            };
            if reached || best.is_none() || cost < lowest {
                best = Some((outcome, cost));
                best_x.copy_from_slice(memory.x());
                best_residual.copy_from_slice(memory.residual());
            }
            let out_of_time = deadline.is_some_and(|deadline| Instant::now() >= deadline);
            let cancelled = outcome.termination == Termination::Cancelled;
            if reached || cancelled || out_of_time || agreeing >= self.restarts.agreeing {
                break;
            }
        }

        if let Some((outcome, cost)) = best {
            solution.termination = outcome.termination;
            solution.projected_gradient = outcome.projected_gradient;
            solution.cost = cost;
        }
        solution.iterations = iterations;
        solution.attempts = attempts;
        solution.counts = counts;
        let mut evaluation = Evaluation::new(problem, scratch);
        let gradient = memory.gradient_at(&mut evaluation, best_x, best_residual);
        solution.measure(problem, best_x, best_residual, gradient);
        Ok(solution)
    }
}

/// Whether an attempt ended because nothing better is near, rather than for lack of patience.
fn settled(termination: Termination) -> bool {
    matches!(
        termination,
        Termination::Stationary | Termination::SmallStep
    )
}

fn check_start(problem: &Problem, start: &[f64]) -> Result<(), SolveError> {
    if start.len() != problem.degrees_of_freedom() {
        return Err(SolveError::StartLength {
            model: problem.names().model.clone(),
            given: start.len(),
            expected: problem.degrees_of_freedom(),
        });
    }
    let leaders = problem.parameters().leaders();
    let bad = leaders.iter().position(|&c| !start[c].is_finite());
    match bad {
        None => Ok(()),
        Some(variable) => Err(SolveError::StartNotFinite {
            joint: problem.names().variables[variable].clone(),
            value: start[leaders[variable]],
        }),
    }
}
