//! Evaluation of the problem of a descent, with counts.

use nalgebra::DMatrix;

use crate::problem::{Evaluation, ProblemInstance, Scratch, TaskSubset};
use crate::solver::{Counts, LeastSquares, SolverState, Stopping};

/// Problem of a descent, the memory to evaluate it, and evaluation counts.
pub(super) struct DescentProblem<'q, 'm> {
    pub(super) instance: ProblemInstance<'q>,
    pub(super) scratch: &'m mut Scratch,
    pub(super) state: &'m mut SolverState,
    pub(super) stopping: Stopping,
    pub(super) deadline: Option<kinopt_kinematics::clock::Instant>,
    pub(super) counts: Counts,
}

impl DescentProblem<'_, '_> {
    pub(super) fn evaluate(&mut self, subset: TaskSubset) -> Evaluation<'_> {
        Evaluation::of(subset, self.instance, self.scratch)
    }

    /// Writes r(x) of a task subset.
    pub(super) fn residual(&mut self, subset: TaskSubset, x: &[f64], residual: &mut [f64]) {
        self.counts.residuals += 1;
        self.evaluate(subset).residual(x, residual);
    }

    /// Writes J(x) of a minimised task subset.
    pub(super) fn jacobian(&mut self, subset: TaskSubset, x: &[f64], jacobian: &mut DMatrix<f64>) {
        self.counts.jacobians += 1;
        self.evaluate(subset).jacobian(x, jacobian);
    }

    /// Writes J(x) of a constrained task subset, with zero rows for errors of unlimited tolerance.
    pub(super) fn constraint_jacobian(
        &mut self,
        subset: TaskSubset,
        x: &[f64],
        jacobian: &mut DMatrix<f64>,
    ) {
        self.jacobian(subset, x, jacobian);
        let rows = jacobian.nrows();
        for free_rows in self.instance.problem.free_rows(subset) {
            for column in jacobian.as_mut_slice().chunks_exact_mut(rows.max(1)) {
                column[free_rows.clone()].fill(0.0);
            }
        }
    }

    /// Writes the slacks of the inequalities of a task subset.
    pub(super) fn slacks(&mut self, subset: TaskSubset, x: &[f64], slacks: &mut [f64]) {
        if !slacks.is_empty() {
            self.counts.residuals += 1;
            self.evaluate(subset).slacks(x, slacks);
        }
    }

    /// Writes the Jacobian of the slacks.
    pub(super) fn slack_jacobian(
        &mut self,
        subset: TaskSubset,
        x: &[f64],
        jacobian: &mut DMatrix<f64>,
    ) {
        if !jacobian.is_empty() {
            self.counts.jacobians += 1;
            self.evaluate(subset).slack_jacobian(x, jacobian);
        }
    }

    /// Returns whether the deadline has passed.
    pub(super) fn is_late(&self) -> bool {
        kinopt_kinematics::clock::is_past(self.deadline)
    }
}
