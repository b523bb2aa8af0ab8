//! The memory of solving, which belongs to the caller.

use std::sync::Arc;

use super::Solution;
use crate::problem::{Names, Problem, Scratch};
use crate::solver::Memory;

/// Scratch memory and room for the solution. Reuse it from solve to solve: after the first on a
/// problem, a solve allocates nothing. It fits any problem, one at a time.
#[derive(Debug, Default)]
pub struct Workspace {
    pub(super) memory: Memory,
    pub(super) scratch: Option<(Arc<Names>, Scratch)>,
    pub(super) start: Vec<f64>,
    pub(super) attempt: Vec<f64>,
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

    /// Takes the problem's shape, unless it already has it.
    pub(super) fn fit(&mut self, problem: &Problem) {
        let known = self
            .scratch
            .as_ref()
            .is_some_and(|(names, _)| Arc::ptr_eq(names, problem.names()));
        if !known {
            self.scratch = Some((Arc::clone(problem.names()), problem.scratch()));
        }
        for vector in [&mut self.start, &mut self.attempt, &mut self.best_x] {
            vector.resize(problem.variables(), 0.0);
        }
        self.best_residual.resize(problem.rows(), 0.0);
        // A first solve that reaches its target names no limit; a later one may name them all.
        self.solution.blocked.clear();
        self.solution.blocked.reserve(problem.variables());
    }
}
