//! Conjugate Gauss-Newton steps for soft tasks (Polak & Ribière 1969).
//!
//! Conjugacy compensates for the curvature of the constraints.

use super::descent::{Descent, DescentResult, multiply};
use super::descent_problem::DescentProblem;
use super::step_limits::StepLimits;
use crate::problem::{ProblemInstance, TaskSubset};
use crate::solver::{Iteration, Observer, StepBounds, Termination};

/// Smallest slope of a conjugate direction, relative to the steepest; below it the direction is restarted.
const MIN_CONJUGATE_SLOPE: f64 = 0.2;
/// Bounds of the ratio of actual to modelled curvature along a direction.
const CURVATURE_RATIO_BOUNDS: (f64, f64) = (0.1, 20.0);

impl Descent {
    /// Descends until the level has converged.
    pub(super) fn descend_by_conjugate_steps(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        StepLimits { steps, halvings }: StepLimits,
        observer: &mut dyn Observer,
    ) -> DescentResult {
        let instance = descent.instance;
        let mut cost = self.cost_at_x(descent);
        descent.counts.residuals += 1;
        let min_relative_decrease = self.constraints.min_relative_decrease();
        let limit = steps.min(descent.stopping.max_iterations());
        let result = |iterations, early_end| DescentResult {
            iterations,
            early_end,
        };
        self.newton.has_stepped = false;
        let (mut iterations, mut curvature_ratio, mut step_length, mut last_slope) =
            (0, 1.0, 0.0, None);
        loop {
            if !cost.is_finite() {
                return result(iterations, Some(Termination::NonFinite));
            }
            let observation = observer.observe(&Iteration {
                index: iterations,
                cost,
                projected_gradient: None,
                step: step_length,
                control: 0.0,
                x: &self.x,
            });
            if observation.is_break() {
                return result(iterations, Some(Termination::Cancelled));
            }
            if descent.is_late() {
                return result(iterations, Some(Termination::TimeLimit));
            }
            if iterations >= limit {
                return result(iterations, Some(Termination::IterationLimit));
            }
            let Some(gauss_newton_slope) = self.compute_gauss_newton_step(descent) else {
                return result(iterations, None);
            };
            // Predicted decrease within the constraints, without rounding errors.
            let predicted =
                gauss_newton_slope.min(inner(&self.residual_changes[0], &self.residual_changes[0]));
            if predicted <= 2.0 * min_relative_decrease * cost {
                return result(iterations, None);
            }
            iterations += 1;
            let Direction { slope, stiffness } =
                self.choose_direction(instance, gauss_newton_slope, last_slope);
            last_slope = Some(gauss_newton_slope);
            let max_fraction = self.max_step_fraction(instance);
            let mut fraction = max_fraction.min(slope / (curvature_ratio * stiffness));
            let mut new_cost = None;
            for _ in 0..halvings {
                let space = instance.space();
                space.integrate_share(&self.x, fraction, &self.direction, &mut self.trial);
                space.project(&mut self.trial);
                let is_feasible = self.correct_trial(descent);
                let trial_cost = match is_feasible {
                    true => self.cost_at_trial(descent),
                    false => f64::INFINITY,
                };
                descent.counts.residuals += usize::from(is_feasible);
                if is_feasible && trial_cost.is_finite() {
                    let ratio = 2.0 * (trial_cost - cost + fraction * slope)
                        / (fraction * fraction * stiffness);
                    curvature_ratio =
                        ratio.clamp(CURVATURE_RATIO_BOUNDS.0, CURVATURE_RATIO_BOUNDS.1);
                }
                if trial_cost < cost {
                    new_cost = Some(trial_cost);
                    break;
                }
                fraction *= 0.5;
                fraction = fraction.min(slope / (curvature_ratio * stiffness));
            }
            let Some(trial_cost) = new_cost else {
                // A restart with the steepest step would exceed the iterations of a frame.
                return result(iterations, None);
            };
            // The swapped-out vectors serve as buffers.
            let displacement = &mut self.last_model_step;
            step_length = instance
                .space()
                .distance(&self.trial, &self.x, displacement);
            std::mem::swap(&mut self.x, &mut self.trial);
            std::mem::swap(&mut self.model_step, &mut self.last_model_step);
            cost = trial_cost;
        }
    }

    /// Writes the Gauss-Newton step into `best`. Returns the slope of the cost along it, if it is finite.
    fn compute_gauss_newton_step(&mut self, descent: &mut DescentProblem<'_, '_>) -> Option<f64> {
        self.cost_at_x(descent);
        descent.jacobian(TaskSubset::rank(self.rank), &self.x, &mut self.jacobian);
        if !self
            .step_solver
            .set_objective(&self.jacobian, &self.residual)
        {
            return None;
        }
        if self.constraints.inequalities.any() {
            let space = descent.instance.space();
            let fixed = self.fixed.iter().enumerate();
            let is_held = fixed.map(|(j, fixed)| *fixed || !space.is_between_bounds(&self.x, j));
            self.newton.is_held.clear();
            self.newton.is_held.extend(is_held);
            self.compute_lagrangian(descent);
            self.constraints.inequalities.require_active_set();
        } else {
            self.constraints
                .compute_rows(descent, &self.x, &self.fixed, false);
        }
        let constraint_rows = self.constraints.rows();
        let bounds = StepBounds {
            x: &self.x,
            space: descent.instance.space(),
            fixed: &self.fixed,
        };
        self.step_solver.minimise(
            constraint_rows,
            &self.jacobian,
            &self.residual,
            &bounds,
            &mut self.model_step,
        );
        let [residual_change, _] = &mut self.residual_changes;
        multiply(&self.jacobian, &self.model_step, residual_change);
        let slope = -inner(residual_change, &self.residual);
        slope.is_finite().then_some(slope)
    }

    /// Makes the step conjugate to the last direction, unless that slope is too small.
    fn choose_direction(
        &mut self,
        instance: ProblemInstance<'_>,
        gauss_newton_slope: f64,
        last_slope: Option<f64>,
    ) -> Direction {
        let [residual_change, last_change] = &mut self.residual_changes;
        let steepest = Direction {
            slope: gauss_newton_slope,
            stiffness: inner(residual_change, residual_change),
        };
        if let Some(last_slope) = last_slope {
            multiply(&self.jacobian, &self.last_model_step, last_change);
            let conjugacy =
                ((gauss_newton_slope - inner(residual_change, last_change)) / last_slope).max(0.0);
            let space = instance.space();
            let steps = self
                .direction
                .iter_mut()
                .zip(&self.model_step)
                .zip(&self.fixed);
            for (j, ((direction, model_step), fixed)) in steps.enumerate() {
                let step = model_step + conjugacy * *direction;
                let outward = space.holds(&self.x, j, -step, 0.0);
                *direction = if outward || *fixed { 0.0 } else { step };
            }
            multiply(&self.jacobian, &self.direction, residual_change);
            let slope = -inner(residual_change, &self.residual);
            if slope >= MIN_CONJUGATE_SLOPE * gauss_newton_slope {
                return Direction {
                    slope,
                    stiffness: inner(residual_change, residual_change),
                };
            }
        }
        self.direction.copy_from_slice(&self.model_step);
        steepest
    }
}

/// Slope and curvature of the cost along a direction.
struct Direction {
    slope: f64,
    stiffness: f64,
}

fn inner(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
