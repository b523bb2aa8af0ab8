//! The memory of solving, which belongs to the caller.

use super::Solution;
use super::attempts::Found;
use crate::problem::{Evaluation, Problem, Scratch};
use crate::solver::{Memory, Stopping, negligible_slope};

/// Scratch memory and room for the solution. Reuse it from solve to solve: after the first on a
/// problem, a solve allocates nothing. It fits any problem, one at a time.
#[derive(Debug, Default)]
pub struct Workspace {
    pub(super) memory: Memory,
    pub(super) scratch: Option<Scratch>,
    pub(super) start: Vec<f64>,
    pub(super) attempt: Vec<f64>,
    pub(super) wander: Vec<bool>,
    /// Where the attempt from the start ended.
    pub(super) first_x: Vec<f64>,
    pub(super) best_x: Vec<f64>,
    pub(super) best_residual: Vec<f64>,
    pub(super) solution: Solution,
}

impl Workspace {
    /// Empty memory, which the first solve fills.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The solution of the last solve.
    #[must_use]
    pub fn solution(&self) -> &Solution {
        &self.solution
    }

    /// Takes the problem's shape and hands out its scratch memory, new only for a new problem.
    pub(super) fn fit(&mut self, problem: &Problem) -> Scratch {
        let Self {
            start,
            attempt,
            first_x,
            best_x,
            ..
        } = self;
        for vector in [start, attempt, first_x, best_x] {
            vector.resize(problem.variables(), 0.0);
        }
        self.wander.resize(problem.variables(), true);
        self.best_residual.resize(problem.rows(), 0.0);
        // A first solve that reaches its target names no limit; a later one may name them all.
        self.solution.blocked.clear();
        self.solution.blocked.reserve(problem.variables());
        match self.scratch.take() {
            Some(scratch) if scratch.fits(problem) => scratch,
            _ => problem.scratch(),
        }
    }

    /// Fills the solution in from what a search found.
    pub(super) fn report(
        &mut self,
        problem: &Problem,
        stopping: &Stopping,
        scratch: &mut Scratch,
        found: &Found,
    ) {
        let solution = &mut self.solution;
        solution.termination = found.outcome.termination;
        solution.projected_gradient = found.outcome.projected_gradient;
        solution.cost = found.cost;
        solution.iterations = found.iterations;
        solution.attempts = found.attempts;
        solution.counts = found.counts;
        let (x, residual) = (&self.best_x, &self.best_residual);
        let (gradient, column_norm): (&[f64], f64) = if problem.is_reached(residual) {
            (&[], 0.0)
        } else {
            let mut evaluation = Evaluation::new(problem, scratch);
            self.memory.slope_at(&mut evaluation, x, residual)
        };
        let negligible = negligible_slope(column_norm, found.cost, stopping);
        solution.measure(problem, x, residual, gradient, negligible);
    }
}
