//! Descent of a priority level in the null space of the levels above.
//!
//! Minimises ½‖r‖² of one level over the configurations at which the levels above keep their results, by successive
//! projection. Each step minimises a model of the level subject to the [constraints](super::held_ranks), followed by
//! the shortest correction back to them. Steps come from [Newton's method](super::newton). Soft tasks below an
//! unreached level take cheaper [conjugate steps](super::conjugate_steps) in a frame of a drag.
//!
//! Conjugate steps would oscillate in frames that reach their targets. The Gauss-Newton model omits the curvature of
//! the constraints, so a step that lowers the cost still overshoots its minimum.

use nalgebra::DMatrix;

use super::descent_problem::DescentProblem;
use super::level_constraints::Held;
use super::newton::NewtonWorkspace;
use super::step_limits::Extent;
use crate::problem::{Problem, ProblemInstance, TaskSubset};
use crate::solver::{HeldStep, LeastSquares, Observer, Termination, half_squared};

/// Longest step of one joint, as a fraction of half a revolution or of the reach.
const LONGEST: f64 = 0.25;

/// Result of a descent. The final variables are in `Descent::x`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Descended {
    pub(super) iterations: usize,
    /// Reason if the descent ended before convergence.
    pub(super) cut: Option<Termination>,
}

/// Start of a descent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Start<'a> {
    pub(super) x: &'a [f64],
    /// Residual of the levels above at `x`.
    pub(super) residual: &'a [f64],
    /// Residual of the first levels, to which the descent first returns; from their own searches.
    pub(super) kept: &'a [f64],
}

/// Descent of one level, with scratch memory.
#[derive(Clone, Debug, Default)]
pub(super) struct Descent {
    pub(super) rank: usize,
    /// Current variables.
    pub(super) x: Vec<f64>,
    pub(super) trial: Vec<f64>,
    /// Step of the linear model, current and previous.
    pub(super) best: Vec<f64>,
    pub(super) last_best: Vec<f64>,
    /// Search direction.
    pub(super) direction: Vec<f64>,
    /// Change of the level's residual by each of two steps.
    pub(super) effects: [Vec<f64>; 2],
    pub(super) fixed: Vec<bool>,
    pub(super) held: Held,
    pub(super) pulls: Vec<f64>,
    pub(super) jacobian: DMatrix<f64>,
    pub(super) step: HeldStep,
    pub(super) newton: NewtonWorkspace,
}

impl Descent {
    /// Resizes for a level of a problem.
    pub(super) fn fit(&mut self, problem: &Problem, rank: usize) {
        let n = problem.variables();
        let pulls = problem.rows_of(TaskSubset::rank(rank));
        self.rank = rank;
        for (vector, room) in [
            (&mut self.x, n),
            (&mut self.trial, n),
            (&mut self.best, n),
            (&mut self.last_best, n),
            (&mut self.direction, n),
            (&mut self.pulls, pulls),
        ] {
            vector.resize(room, 0.0);
        }
        for effect in &mut self.effects {
            effect.resize(pulls, 0.0);
        }
        self.fixed.resize(n, false);
        if self.jacobian.shape() != (pulls, n) {
            self.jacobian = DMatrix::zeros(pulls, n);
        }
        let held = self.held.fit(problem, rank);
        let rows = problem.rows_of(TaskSubset::above(rank + 1));
        self.newton.fit(n, rows, problem.edges_above(rank + 1));
        self.step.reserve(held, pulls, n);
    }

    /// Descends until the level has converged or its step limit is reached.
    pub(super) fn run(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        from: &Start<'_>,
        extent: Extent,
        observer: &mut dyn Observer,
    ) -> Descended {
        let is_level = self.rank < descent.question.problem.ranks().levels();
        self.x.copy_from_slice(from.x);
        let Self { held, fixed, .. } = self;
        let reached = held.take(descent, self.rank, from.x, from.residual, fixed);
        if reached && !from.kept.is_empty() {
            self.return_to(descent, from.kept);
        }
        let steps = match is_level {
            true => extent.of_levels(),
            false => extent.of_preferences(reached),
        };
        match is_level || reached || extent == Extent::Whole {
            true => self.by_newton(descent, steps, observer),
            false => self.by_conjugate_steps(descent, steps, observer),
        }
    }

    /// Moves to where the first rows have the residual of their own searches, if the correction converges.
    fn return_to(&mut self, descent: &mut DescentProblem<'_, '_>, kept: &[f64]) {
        self.cost_at_x(descent);
        descent.jacobian(TaskSubset::rank(self.rank), &self.x, &mut self.jacobian);
        if !self.step.take_pulls(&self.jacobian, &self.pulls) {
            return;
        }
        self.trial.copy_from_slice(&self.x);
        let here = self.held.keep(kept);
        match self.bring_back(descent) {
            true => self.x.copy_from_slice(&self.trial),
            false => {
                self.held.keep(&here);
            }
        }
    }

    /// Corrects the trial back to the constraints. Returns whether it satisfies them.
    pub(super) fn bring_back(&mut self, descent: &mut DescentProblem<'_, '_>) -> bool {
        (self.held).bring_back(descent, &mut self.trial, &mut self.step, &self.fixed)
    }

    /// Returns whether the required tasks of the level are reached by the last residual. A level with soft tasks is
    /// never reached.
    pub(super) fn is_reached(&self, problem: &Problem) -> bool {
        let share = TaskSubset::rank(self.rank);
        self.rank < problem.ranks().levels()
            && !problem.pulls_in(share)
            && problem.is_reached_by(share, &self.pulls)
    }

    pub(super) fn cost_at_x(&mut self, descent: &mut DescentProblem<'_, '_>) -> f64 {
        let mut pulls = descent.evaluate(TaskSubset::rank(self.rank));
        pulls.residual(&self.x, &mut self.pulls);
        half_squared(&self.pulls)
    }

    pub(super) fn cost_at_trial(&mut self, descent: &mut DescentProblem<'_, '_>) -> f64 {
        let mut pulls = descent.evaluate(TaskSubset::rank(self.rank));
        pulls.residual(&self.trial, &mut self.pulls);
        half_squared(&self.pulls)
    }

    /// Returns the largest fraction of the direction that keeps every joint within its longest step.
    pub(super) fn longest_share(&self, question: ProblemInstance<'_>) -> f64 {
        let moves = self.direction.iter().enumerate();
        let longest = moves.map(|(j, step)| step.abs() / (LONGEST * question.problem.spread(j)));
        1.0 / longest.fold(f64::MIN_POSITIVE, f64::max)
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
