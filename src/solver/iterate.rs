//! View of a search at its current point, for methods.

use std::ops::Deref;

use super::linear::add_scaled;
use super::state::half_squared;
use super::{ConfigurationSpace, LeastSquares, SolverState};

/// Relative change of the cost up to which a step counts as flat.
const FLAT: f64 = 1e-13;

/// Current point of a search, as a method sees it: it reads like its [`SolverState`], has the bounds, and tries steps.
///
/// A method writes its step Δ, projects it into the bounds, evaluates the trial x + Δ, and accepts it or not.
pub struct Iterate<'a> {
    pub(super) problem: &'a mut dyn LeastSquares,
    pub(super) state: &'a mut SolverState,
}

impl std::fmt::Debug for Iterate<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut shown = f.debug_struct("Iterate");
        shown.field("state", self.state).finish_non_exhaustive()
    }
}

impl Deref for Iterate<'_> {
    type Target = SolverState;

    fn deref(&self) -> &SolverState {
        self.state
    }
}

impl Iterate<'_> {
    getters! {
        /// Configuration space of x, with its bounds.
        pub fn space(&self) -> ConfigurationSpace<'_> = self.problem.space();
        /// Step Δ, for writing; it holds the last step until then.
        pub fn step_mut(&mut self) -> &mut [f64] = &mut self.state.step;
    }

    /// Projects the trial x + Δ into the bounds, shortens it to the share that the problem allows, and updates Δ to
    /// match.
    pub fn project_step(&mut self) {
        let SolverState { x, step, trial, .. } = &mut *self.state;
        let space = self.problem.space();
        space.integrate(x, step, trial);
        space.project(trial);
        space.difference(trial, x, step);
        let share = self.problem.allowed_share(x, trial);
        if share < 1.0 {
            let space = self.problem.space();
            for part in step.iter_mut() {
                *part *= share;
            }
            space.integrate(x, step, trial);
            space.project(trial);
            space.difference(trial, x, step);
        }
    }

    /// ½‖r + J Δ‖²: the cost that the linear model predicts for the step. Overwrites the trial's residual.
    pub fn model_cost(&mut self) -> f64 {
        let at = &mut *self.state;
        let predicted = &mut at.trial_residual;
        predicted.copy_from_slice(&at.residual);
        let columns = at.jacobian.as_slice();
        let columns = columns.chunks_exact(at.residual.len().max(1));
        for (&step, column) in at.step.iter().zip(columns) {
            if step != 0.0 {
                add_scaled(predicted, step, column);
            }
        }
        half_squared(predicted)
    }

    /// Evaluates the projected trial and returns its cost.
    pub fn evaluate_trial(&mut self) -> f64 {
        let at = &mut *self.state;
        self.problem.residual(&at.trial, &mut at.trial_residual);
        at.counts.residuals += 1;
        at.trial_cost = half_squared(&at.trial_residual);
        at.trial_cost
    }

    /// Makes the evaluated trial the current point. Derivatives are evaluated again before the next step.
    pub fn accept(&mut self) {
        let at = &mut *self.state;
        std::mem::swap(&mut at.x, &mut at.trial);
        std::mem::swap(&mut at.residual, &mut at.trial_residual);
        let flat = (at.cost - at.trial_cost).abs() <= FLAT * at.cost;
        at.flat_steps = if flat { at.flat_steps + 1 } else { 0 };
        at.cost = at.trial_cost;
        if at.cost < at.best_cost {
            at.best_cost = at.cost;
            at.best_x.copy_from_slice(&at.x);
        }
    }
}
