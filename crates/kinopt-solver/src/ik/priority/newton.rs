//! Newton's method for the descent of a level in the null space of the levels above.
//!
//! An unreached level keeps a residual, so JᵀJ lacks curvature along the remaining directions. Differences of its
//! gradient give the Hessian of L = ½‖r‖² + λᵀr↑ along them. The multipliers λ are those of the levels above (Nocedal &
//! Wright 2006, section 18.3). The Hessian is damped until the model has a minimum and predicts the decrease well. The
//! active bounds are those of the last step, except those pulled inward. When that gains nothing more, the next step
//! reconsiders all bounds.

use super::descent::{Descent, DescentResult};
use super::descent_problem::DescentProblem;
use super::slope_differences::{SlopeDifferences, clear_fixed};
use super::step_limits::StepLimits;
use crate::problem::TaskSubset;
use crate::solver::{Iteration, Observer, RowSpan, TangentNewton, Termination, dot};

/// Initial and smallest non-zero damping, relative to the largest entry of the Hessian.
const INITIAL_DAMPING: f64 = 1e-4;
const MIN_DAMPING: f64 = 1e-9;
/// Factor that raises the damping after a failed step and lowers it after a good one.
const DAMPING_FACTOR: f64 = 5.0;
/// Smallest ratio of actual to predicted decrease of a good step.
const MIN_GOOD_GAIN_RATIO: f64 = 0.7;
/// Largest ratio of actual to predicted decrease of a poor step.
const MAX_POOR_GAIN_RATIO: f64 = 0.2;
/// Maximum number of consecutive dampings without a decrease.
const MAX_DAMPING_TRIALS: usize = 14;
/// Predicted decrease, relative to the cost, that rounding errors hide.
const ROUNDING_TOLERANCE: f64 = 1e-13;
/// Projected gradient, relative to the norms of Jacobian and residual, below which the level has converged.
const GRADIENT_TOLERANCE: f64 = 1e-10;

/// Scratch memory of Newton's method.
#[derive(Clone, Debug, Default)]
pub(super) struct NewtonWorkspace {
    pub(super) higher_span: RowSpan,
    /// True if a bound or a lock holds each variable.
    pub(super) is_held: Vec<bool>,
    /// True if the last step's model ended on a bound of each variable. Valid if `has_stepped`.
    pub(super) ended_on_bound: Vec<bool>,
    pub(super) has_stepped: bool,
    /// True if the next step's model reconsiders the active bounds.
    ///
    /// Such models are indefinite more often, and their steps are shorter.
    pub(super) reconsiders_bounds: bool,
    /// True if the trial is on a bound of each variable.
    pub(super) is_trial_on_bound: Vec<bool>,
    /// Gradient ∇L, and its projection onto the free directions.
    pub(super) slope: Vec<f64>,
    projected_slope: Vec<f64>,
    /// Weights of the gradients of all rows in ∇L, and of the inequalities.
    pub(super) row_weights: Vec<f64>,
    pub(super) inequality_multipliers: Vec<f64>,
    pub(super) differences: SlopeDifferences,
    pub(super) model: TangentNewton,
}

impl NewtonWorkspace {
    /// Resizes for a number of variables, rows of a level and those above it, and inequalities.
    pub(super) fn fit(&mut self, variables: usize, rows: usize, edges: usize) {
        self.is_held.resize(variables, false);
        self.ended_on_bound.resize(variables, false);
        self.is_trial_on_bound.resize(variables, false);
        self.slope.resize(variables, 0.0);
        self.projected_slope.resize(variables, 0.0);
        self.row_weights.resize(rows, 0.0);
        self.inequality_multipliers.resize(edges, 0.0);
        self.differences.fit(variables, rows);
        self.higher_span.reserve(variables, variables);
        self.model.reserve(variables);
    }
}

/// Result of the steps of one model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum TrialResult {
    Decreased,
    /// The predicted decrease is hidden by rounding; `is_cost_unchanged`: whether the cost stays the same within
    /// rounding.
    Hidden {
        is_cost_unchanged: bool,
    },
    NoDecrease,
}

impl TrialResult {
    /// Returns whether the descent continues from the trial.
    fn accepts_trial(self) -> bool {
        matches!(
            self,
            Self::Decreased
                | Self::Hidden {
                    is_cost_unchanged: true
                }
        )
    }
}

impl Descent {
    /// Descends until the level is reached or has converged.
    pub(super) fn descend_by_newton(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        StepLimits { steps, .. }: StepLimits,
        observer: &mut dyn Observer,
    ) -> DescentResult {
        let instance = descent.instance;
        let limit = steps.min(descent.stopping.max_iterations());
        let (mut iterations, mut step_length, mut dampings) = (0, 0.0, [None; 2]);
        let result = |iterations, early_end| DescentResult {
            iterations,
            early_end,
        };
        (self.newton.reconsiders_bounds, self.newton.has_stepped) = (true, false);
        loop {
            let cost = self.cost_at_x(descent);
            if !cost.is_finite() {
                return result(iterations, Some(Termination::NonFinite));
            }
            let damping_index = usize::from(self.newton.reconsiders_bounds);
            let observation = observer.observe(&Iteration {
                index: iterations,
                cost,
                projected_gradient: None,
                step: step_length,
                control: dampings[damping_index].unwrap_or(0.0),
                x: &self.x,
            });
            if observation.is_break() {
                return result(iterations, Some(Termination::Cancelled));
            }
            if descent.is_late() {
                return result(iterations, Some(Termination::TimeLimit));
            }
            if self.is_reached(instance.problem) || self.has_converged(descent) {
                return result(iterations, None);
            }
            if iterations >= limit {
                return result(iterations, Some(Termination::IterationLimit));
            }
            iterations += 1;
            if !self
                .step_solver
                .set_objective(&self.jacobian, &self.residual)
            {
                return result(iterations, None);
            }
            let (trial_result, damping) = self.try_dampings(descent, cost, dampings[damping_index]);
            dampings[damping_index] = Some(damping);
            if trial_result.accepts_trial() {
                // The swapped-out vector serves as a buffer.
                let displacement = &mut self.last_model_step;
                step_length = instance
                    .space()
                    .distance(&self.trial, &self.x, displacement);
                std::mem::swap(&mut self.x, &mut self.trial);
            }
            let has_active_constraints =
                self.newton.is_held != self.fixed || self.constraints.inequalities.has_active();
            self.newton.reconsiders_bounds = match trial_result {
                TrialResult::Decreased => false,
                _ if damping_index == 0 && has_active_constraints => true,
                _ => return result(iterations, None),
            };
        }
    }

    /// Tries steps with increasing damping until one decreases the cost. Returns the damping for the next step.
    fn try_dampings(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        cost: f64,
        damping: Option<f64>,
    ) -> (TrialResult, f64) {
        self.compute_hessian(descent);
        let max_stiffness = self.newton.model.max_stiffness();
        let raised_damping =
            |damping: f64| DAMPING_FACTOR * damping.max(MIN_DAMPING * max_stiffness);
        let mut damping = damping.unwrap_or(INITIAL_DAMPING * max_stiffness);
        for _ in 0..MAX_DAMPING_TRIALS {
            let Some(predicted) = self.compute_newton_step(descent, damping) else {
                damping = raised_damping(damping);
                continue;
            };
            let decrease = cost - self.try_step(descent);
            // A decrease that rounding hides cannot be verified.
            if predicted <= ROUNDING_TOLERANCE * cost {
                let is_cost_unchanged = decrease >= -ROUNDING_TOLERANCE * cost;
                return (TrialResult::Hidden { is_cost_unchanged }, damping);
            }
            let gain_ratio = decrease / predicted;
            if gain_ratio > MIN_GOOD_GAIN_RATIO {
                damping /= DAMPING_FACTOR;
                if damping < MIN_DAMPING * max_stiffness {
                    damping = 0.0;
                }
            } else if gain_ratio < MAX_POOR_GAIN_RATIO {
                damping = raised_damping(damping);
            }
            if decrease > 0.0 {
                return (TrialResult::Decreased, damping);
            }
        }
        (TrialResult::NoDecrease, damping)
    }

    /// Computes ∇L and its projection at x. Returns whether the level has converged.
    fn has_converged(&mut self, descent: &mut DescentProblem<'_, '_>) -> bool {
        let subset = TaskSubset::rank(self.rank);
        descent.jacobian(subset, &self.x, &mut self.jacobian);
        let newton = &mut self.newton;
        let space = descent.instance.space();
        let columns = self
            .jacobian
            .as_slice()
            .chunks_exact(self.residual.len().max(1));
        let mut max_squared_column_norm = 0.0_f64;
        for (j, column) in columns.enumerate() {
            max_squared_column_norm = max_squared_column_norm.max(dot(column, column));
            let is_on_bound = !space.is_between_bounds(&self.x, j);
            let may_stay = !newton.has_stepped || newton.ended_on_bound[j];
            newton.is_held[j] = self.fixed[j] || (is_on_bound && may_stay);
        }
        self.compute_constraints(descent);
        loop {
            self.compute_multipliers(descent);
            // Releases bounds that are pulled inward.
            let newton = &mut self.newton;
            let mut has_released = false;
            for (j, is_held) in newton.is_held.iter_mut().enumerate() {
                let is_pushed = self.fixed[j] || space.holds(&self.x, j, newton.slope[j], 0.0);
                has_released |= *is_held && !is_pushed;
                *is_held &= is_pushed;
            }
            if has_released {
                newton.higher_span.clear();
                self.constraints.add_to_span(
                    descent.instance.problem,
                    &mut newton.higher_span,
                    &newton.is_held,
                );
                self.constraints
                    .add_active_to_span(&mut newton.higher_span, &newton.is_held);
            }
            // The signs of the inequality multipliers may change after that.
            if !has_released || !self.constraints.inequalities.has_active() {
                break;
            }
        }
        let (newton, constraints) = (&mut self.newton, &mut self.constraints);
        newton.projected_slope.clone_from(&newton.slope);
        clear_fixed(&mut newton.projected_slope, &newton.is_held);
        newton.higher_span.project_out(&mut newton.projected_slope);
        let has_active_constraints =
            newton.is_held != self.fixed || constraints.inequalities.has_active();
        if newton.reconsiders_bounds && has_active_constraints {
            newton.higher_span.clear();
            constraints.add_to_span(
                descent.instance.problem,
                &mut newton.higher_span,
                &self.fixed,
            );
        }
        constraints
            .inequalities
            .subtract_active_terms(&newton.inequality_multipliers, &mut newton.slope);
        let projected_slope_norm = dot(&newton.projected_slope, &newton.projected_slope).sqrt();
        projected_slope_norm
            <= GRADIENT_TOLERANCE
                * (max_squared_column_norm * dot(&self.residual, &self.residual)).sqrt()
    }
}
