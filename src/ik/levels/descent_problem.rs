//! The problem that a descent solves, its memory, and how often it was evaluated.

use nalgebra::DMatrix;

use crate::problem::{Evaluation, Question, Scratch, Share};
use crate::solver::{Counts, LeastSquares, SolverState, Stopping};

/// What a descent is of, the memory to evaluate it, and how often that was done.
pub(super) struct DescentProblem<'q, 'm> {
    pub(super) question: Question<'q>,
    pub(super) scratch: &'m mut Scratch,
    pub(super) memory: &'m mut SolverState,
    pub(super) stopping: Stopping,
    pub(super) deadline: Option<crate::clock::Instant>,
    pub(super) counts: Counts,
}

impl DescentProblem<'_, '_> {
    pub(super) fn evaluate(&mut self, share: Share) -> Evaluation<'_> {
        Evaluation::of(share, self.question, self.scratch)
    }

    /// r(x) of a share.
    pub(super) fn residual(&mut self, share: Share, x: &[f64], residual: &mut [f64]) {
        self.counts.residuals += 1;
        self.evaluate(share).residual(x, residual);
    }

    /// J(x) of a share that pulls.
    pub(super) fn jacobian(&mut self, share: Share, x: &[f64], jacobian: &mut DMatrix<f64>) {
        self.counts.jacobians += 1;
        self.evaluate(share).jacobian(x, jacobian);
    }

    /// J(x) of a share that is held: rows for which any error will do hold nothing.
    pub(super) fn held_jacobian(&mut self, share: Share, x: &[f64], jacobian: &mut DMatrix<f64>) {
        self.jacobian(share, x, jacobian);
        let rows = jacobian.nrows();
        for free in self.question.problem.free_rows(share) {
            for column in jacobian.as_mut_slice().chunks_exact_mut(rows.max(1)) {
                column[free.clone()].fill(0.0);
            }
        }
    }

    /// How deep the goals of a share of the first ranks are within the edges of their rooms.
    pub(super) fn depths(&mut self, share: Share, x: &[f64], depths: &mut [f64]) {
        if !depths.is_empty() {
            self.counts.residuals += 1;
            self.evaluate(share).depths(x, depths);
        }
    }

    /// The derivatives of that.
    pub(super) fn depth_jacobian(&mut self, share: Share, x: &[f64], jacobian: &mut DMatrix<f64>) {
        if !jacobian.is_empty() {
            self.counts.jacobians += 1;
            self.evaluate(share).depth_jacobian(x, jacobian);
        }
    }

    /// Whether it is too late to go on.
    pub(super) fn is_late(&self) -> bool {
        crate::clock::is_past(self.deadline)
    }
}
