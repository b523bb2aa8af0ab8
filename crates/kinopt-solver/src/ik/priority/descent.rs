//! Descent of a priority level in the null space of the levels above.
//!
//! Minimises ½‖r‖² of one level over the configurations at which the levels above keep their results, by successive
//! projection. Each step minimises a model of the level subject to the [constraints](super::level_constraints),
//! followed by the shortest correction back to them. Steps come from [Newton's method](super::newton). Soft tasks below
//! an unreached level take cheaper [conjugate steps](super::conjugate_steps) in a frame of a drag.
//!
//! Conjugate steps would oscillate in frames that reach their targets. The Gauss-Newton model omits the curvature of
//! the constraints, so a step that lowers the cost still overshoots its minimum.

use nalgebra::DMatrix;

use super::descent_problem::DescentProblem;
use super::level_constraints::LevelConstraints;
use super::newton::NewtonWorkspace;
use super::step_limits::Extent;
use crate::problem::{Problem, ProblemInstance, TaskSubset};
use crate::solver::{HeldStep, LeastSquares, Observer, Termination, half_squared};

/// Longest step of one joint, as a fraction of half a revolution or of the reach.
const MAX_JOINT_STEP: f64 = 0.25;

/// Result of a descent. The final variables are in `Descent::x`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct DescentResult {
    pub(super) iterations: usize,
    /// Reason if the descent ended before convergence.
    pub(super) early_end: Option<Termination>,
}

/// Start of a descent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Start<'a> {
    pub(super) x: &'a [f64],
    /// Residual of the levels above at `x`.
    pub(super) residual: &'a [f64],
    /// Residual of the first levels, to which the descent first returns; from their own searches.
    pub(super) held_residual: &'a [f64],
}

/// Descent of one level, with scratch memory.
#[derive(Clone, Debug, Default)]
pub(super) struct Descent {
    pub(super) rank: usize,
    /// Current variables.
    pub(super) x: Vec<f64>,
    pub(super) trial: Vec<f64>,
    /// Step of the linear model, current and previous.
    pub(super) model_step: Vec<f64>,
    pub(super) last_model_step: Vec<f64>,
    /// Search direction.
    pub(super) direction: Vec<f64>,
    /// Change of the level's residual by each of two steps.
    pub(super) residual_changes: [Vec<f64>; 2],
    pub(super) fixed: Vec<bool>,
    pub(super) constraints: LevelConstraints,
    pub(super) residual: Vec<f64>,
    pub(super) jacobian: DMatrix<f64>,
    pub(super) step_solver: HeldStep,
    pub(super) newton: NewtonWorkspace,
}

impl Descent {
    /// Resizes for a level of a problem.
    pub(super) fn fit(&mut self, problem: &Problem, rank: usize) {
        let n = problem.variables();
        let level_rows = problem.rows_of(TaskSubset::rank(rank));
        self.rank = rank;
        for (vector, len) in [
            (&mut self.x, n),
            (&mut self.trial, n),
            (&mut self.model_step, n),
            (&mut self.last_model_step, n),
            (&mut self.direction, n),
            (&mut self.residual, level_rows),
        ] {
            vector.resize(len, 0.0);
        }
        for residual_change in &mut self.residual_changes {
            residual_change.resize(level_rows, 0.0);
        }
        self.fixed.resize(n, false);
        if self.jacobian.shape() != (level_rows, n) {
            self.jacobian = DMatrix::zeros(level_rows, n);
        }
        let constraint_rows = self.constraints.fit(problem, rank);
        let rows = problem.rows_of(TaskSubset::above(rank + 1));
        self.newton.fit(n, rows, problem.slacks_above(rank + 1));
        self.step_solver.reserve(constraint_rows, level_rows, n);
    }

    /// Descends until the level has converged or its step limit is reached.
    pub(super) fn run(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        start: &Start<'_>,
        extent: Extent,
        observer: &mut dyn Observer,
    ) -> DescentResult {
        let is_level = self.rank < descent.instance.problem.ranks().levels();
        self.x.copy_from_slice(start.x);
        let Self {
            constraints, fixed, ..
        } = self;
        let reached = constraints.constrain_to(descent, self.rank, start.x, start.residual, fixed);
        if reached && !start.held_residual.is_empty() {
            self.restore_residual(descent, start.held_residual);
        }
        let limits = match is_level {
            true => extent.level_steps(),
            false => extent.soft_task_steps(reached),
        };
        match is_level || reached || extent == Extent::Whole {
            true => self.descend_by_newton(descent, limits, observer),
            false => self.descend_by_conjugate_steps(descent, limits, observer),
        }
    }

    /// Moves to where the first rows have the residual of their own searches, if the correction converges.
    fn restore_residual(&mut self, descent: &mut DescentProblem<'_, '_>, held_residual: &[f64]) {
        self.cost_at_x(descent);
        descent.jacobian(TaskSubset::rank(self.rank), &self.x, &mut self.jacobian);
        if !self
            .step_solver
            .set_objective(&self.jacobian, &self.residual)
        {
            return;
        }
        self.trial.copy_from_slice(&self.x);
        let previous = self.constraints.set_held_residual(held_residual);
        match self.correct_trial(descent) {
            true => self.x.copy_from_slice(&self.trial),
            false => {
                self.constraints.set_held_residual(&previous);
            }
        }
    }

    /// Corrects the trial back to the constraints. Returns whether it satisfies them.
    pub(super) fn correct_trial(&mut self, descent: &mut DescentProblem<'_, '_>) -> bool {
        (self.constraints).correct_trial(
            descent,
            &mut self.trial,
            &mut self.step_solver,
            &self.fixed,
        )
    }

    /// Returns whether the required tasks of the level are reached by the last residual. A level with soft tasks is
    /// never reached.
    pub(super) fn is_reached(&self, problem: &Problem) -> bool {
        let subset = TaskSubset::rank(self.rank);
        self.rank < problem.ranks().levels()
            && !problem.has_soft_tasks(subset)
            && problem.is_reached_by(subset, &self.residual)
    }

    pub(super) fn cost_at_x(&mut self, descent: &mut DescentProblem<'_, '_>) -> f64 {
        let mut evaluation = descent.evaluate(TaskSubset::rank(self.rank));
        evaluation.residual(&self.x, &mut self.residual);
        half_squared(&self.residual)
    }

    pub(super) fn cost_at_trial(&mut self, descent: &mut DescentProblem<'_, '_>) -> f64 {
        let mut evaluation = descent.evaluate(TaskSubset::rank(self.rank));
        evaluation.residual(&self.trial, &mut self.residual);
        half_squared(&self.residual)
    }

    /// Returns the largest fraction of the direction that keeps every joint within its longest step.
    pub(super) fn max_step_fraction(&self, instance: ProblemInstance<'_>) -> f64 {
        let steps = self.direction.iter().enumerate();
        let ratios =
            steps.map(|(j, step)| step.abs() / (MAX_JOINT_STEP * instance.problem.spread(j)));
        1.0 / ratios.fold(f64::MIN_POSITIVE, f64::max)
    }
}

/// Writes J Δ.
pub(super) fn multiply(jacobian: &DMatrix<f64>, step: &[f64], product: &mut [f64]) {
    product.fill(0.0);
    let columns = jacobian.as_slice().chunks_exact(product.len().max(1));
    for (column, &step) in columns.zip(step).filter(|(_, step)| **step != 0.0) {
        for (sum, entry) in product.iter_mut().zip(column) {
            *sum += step * entry;
        }
    }
}
