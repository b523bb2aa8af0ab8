//! Newton step of a level: model, minimiser and trial.

use super::descent::Descent;
use super::descent_problem::DescentProblem;
use super::slope_differences::WeightedGradient;
use crate::problem::TaskSubset;
use crate::solver::{StepBounds, dot};

impl Descent {
    /// Computes ∇²L along the free directions at x.
    pub(super) fn compute_hessian(&mut self, descent: &mut DescentProblem<'_, '_>) {
        let newton = &mut self.newton;
        let rows = newton.row_weights.len();
        let lagrangian = WeightedGradient {
            subset: TaskSubset::above(self.rank + 1),
            multipliers: &newton.row_weights,
            inequality_multipliers: &newton.inequality_multipliers,
            residual_rows: rows - self.residual.len()..rows,
        };
        let fixed = match newton.reconsiders_bounds {
            true => &self.fixed,
            false => &newton.is_held,
        };
        (newton.higher_span).complement(fixed, &mut newton.model.directions);
        newton
            .differences
            .set_base_point(descent, &lagrangian, &self.x);
        newton
            .model
            .compute_hessian(self.x.len(), |direction, image| {
                (newton.differences).derivative_along(
                    descent,
                    &lagrangian,
                    (&self.x, direction),
                    image,
                );
            });
    }

    /// Writes the damped step into `best`, limited to the longest joint step. Returns the predicted decrease if the
    /// model has a minimum.
    pub(super) fn compute_newton_step(
        &mut self,
        descent: &DescentProblem<'_, '_>,
        damping: f64,
    ) -> Option<f64> {
        let newton = &mut self.newton;
        let (is_held, keeps_active_set) = (&newton.is_held, !newton.reconsiders_bounds);
        let bounds = StepBounds {
            x: &self.x,
            space: descent.instance.space(),
            fixed: if keeps_active_set {
                is_held
            } else {
                &self.fixed
            },
        };
        let (slope, inequalities) = (
            &newton.slope,
            self.constraints.inequalities.inequalities(keeps_active_set),
        );
        let model_decrease =
            (newton.model).minimise(damping, slope, &bounds, inequalities, &mut self.model_step)?;
        newton
            .model
            .write_held_variables(&mut newton.ended_on_bound);
        for (ended_on_bound, is_held) in newton.ended_on_bound.iter_mut().zip(is_held) {
            *ended_on_bound |= *is_held && keeps_active_set;
        }
        newton.has_stepped = true;
        self.direction.copy_from_slice(&self.model_step);
        let fraction = self.max_step_fraction(descent.instance).min(1.0);
        for entry in &mut self.model_step {
            *entry *= fraction;
        }
        let resting_edges = self.newton.model.holding_inequalities();
        self.constraints.inequalities.record_step_end(
            resting_edges,
            keeps_active_set,
            fraction == 1.0,
        );
        let linear_decrease = -dot(&self.newton.slope, &self.direction);
        let predicted =
            fraction * (linear_decrease - fraction * (linear_decrease - model_decrease));
        (predicted > 0.0).then_some(predicted)
    }

    /// Returns the level's cost after the step, or infinity if the trial cannot satisfy the constraints.
    pub(super) fn try_step(&mut self, descent: &mut DescentProblem<'_, '_>) -> f64 {
        let space = descent.instance.space();
        space.integrate(&self.x, &self.model_step, &mut self.trial);
        space.project(&mut self.trial);
        // Variables that reached a bound stay there if that is feasible.
        for (j, is_on_bound) in self.newton.is_trial_on_bound.iter_mut().enumerate() {
            *is_on_bound = self.fixed[j] || !space.is_between_bounds(&self.trial, j);
        }
        let is_on_bound = &self.newton.is_trial_on_bound;
        let mut is_feasible = (self.constraints).correct_trial(
            descent,
            &mut self.trial,
            &mut self.step_solver,
            is_on_bound,
        );
        if !is_feasible && *is_on_bound != self.fixed {
            space.integrate(&self.x, &self.model_step, &mut self.trial);
            space.project(&mut self.trial);
            is_feasible = self.correct_trial(descent);
        }
        if !is_feasible {
            return f64::INFINITY;
        }
        descent.counts.residuals += 1;
        let cost = self.cost_at_trial(descent);
        if cost.is_finite() {
            cost
        } else {
            f64::INFINITY
        }
    }
}
