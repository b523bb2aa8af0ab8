//! View of a search at its current point, for methods.

use std::ops::Deref;

use super::linear::add_scaled;
use super::state::half_squared;
use super::{ConfigurationSpace, LeastSquares, SolverState};

/// Relative change of the cost up to which a step counts as flat.
const FLAT_CHANGE: f64 = 1e-13;

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
    /// Configuration space of x, with its bounds.
    #[must_use]
    pub fn space(&self) -> ConfigurationSpace<'_> {
        self.problem.space()
    }

    /// Step Δ, for writing; it holds the last step until then.
    #[must_use]
    pub fn step_mut(&mut self) -> &mut [f64] {
        &mut self.state.step
    }

    /// Projects the trial x + Δ into the bounds, shortens it to the fraction that the problem allows, and updates Δ to
    /// match.
    pub fn project_step(&mut self) {
        let SolverState { x, step, trial, .. } = &mut *self.state;
        let space = self.problem.space();
        space.integrate(x, step, trial);
        space.project(trial);
        space.difference(trial, x, step);
        let fraction = self.problem.allowed_share(x, trial);
        if fraction < 1.0 {
            let space = self.problem.space();
            for part in step.iter_mut() {
                *part *= fraction;
            }
            space.integrate(x, step, trial);
            space.project(trial);
            space.difference(trial, x, step);
        }
    }

    /// ½‖r + J Δ‖²: the cost that the linear model predicts for the step. Overwrites the trial's residual.
    pub fn model_cost(&mut self) -> f64 {
        let state = &mut *self.state;
        let predicted = &mut state.trial_residual;
        predicted.copy_from_slice(&state.residual);
        let columns = state.jacobian.as_slice();
        let columns = columns.chunks_exact(state.residual.len().max(1));
        for (&step, column) in state.step.iter().zip(columns) {
            if step != 0.0 {
                add_scaled(predicted, step, column);
            }
        }
        half_squared(predicted)
    }

    /// Evaluates the projected trial and returns its cost.
    pub fn evaluate_trial(&mut self) -> f64 {
        let state = &mut *self.state;
        self.problem
            .residual(&state.trial, &mut state.trial_residual);
        state.counts.residuals += 1;
        state.trial_cost = half_squared(&state.trial_residual);
        state.trial_cost
    }

    /// Makes the evaluated trial the current point. Derivatives are evaluated again before the next step.
    pub fn accept(&mut self) {
        let state = &mut *self.state;
        std::mem::swap(&mut state.x, &mut state.trial);
        std::mem::swap(&mut state.residual, &mut state.trial_residual);
        let is_flat = (state.cost - state.trial_cost).abs() <= FLAT_CHANGE * state.cost;
        state.flat_steps = if is_flat { state.flat_steps + 1 } else { 0 };
        state.cost = state.trial_cost;
        if state.cost < state.best_cost {
            state.best_cost = state.cost;
            state.best_x.copy_from_slice(&state.x);
        }
    }
}
