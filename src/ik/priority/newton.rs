//! Newton's method for the descent of a level in the null space of the levels above.
//!
//! An unreached level keeps a residual, so JᵀJ lacks curvature along the remaining directions. Differences of its
//! gradient give the Hessian of L = ½‖r‖² + λᵀr↑ along them. The multipliers λ are those of the levels above (Nocedal &
//! Wright 2006, section 18.3). The Hessian is damped until the model has a minimum and predicts the decrease well. The
//! active bounds are those of the last step, except those pulled inward. When that gains nothing more, the next step
//! reconsiders all bounds.

use super::descent::{Descended, Descent};
use super::descent_problem::DescentProblem;
use super::slope_differences::{SlopeDifferences, release};
use super::step_limits::Steps;
use crate::problem::TaskSubset;
use crate::solver::{Iteration, Observer, RowSpan, TangentNewton, Termination, dot};

/// Initial and smallest non-zero damping, relative to the largest entry of the Hessian.
const FIRST_DAMPING: f64 = 1e-4;
const LEAST_DAMPING: f64 = 1e-9;
/// Factor that raises the damping after a failed step and lowers it after a good one.
const FACTOR: f64 = 5.0;
/// Smallest ratio of actual to predicted decrease of a good step.
const GOOD: f64 = 0.7;
/// Largest ratio of actual to predicted decrease of a poor step.
const POOR: f64 = 0.2;
/// Maximum number of consecutive dampings without a decrease.
const TRIALS: usize = 14;
/// Predicted decrease, relative to the cost, that rounding errors hide.
const HIDDEN: f64 = 1e-13;
/// Projected gradient, relative to the norms of Jacobian and residual, below which the level has converged.
const LEVEL: f64 = 1e-10;

/// Scratch memory of Newton's method.
#[derive(Clone, Debug, Default)]
pub(super) struct NewtonWorkspace {
    pub(super) above: RowSpan,
    /// True if a bound or a lock holds each variable.
    pub(super) pinned: Vec<bool>,
    /// True if the last step's model ended on a bound of each variable. Valid if `has_stepped`.
    pub(super) resting: Vec<bool>,
    pub(super) has_stepped: bool,
    /// True if the next step's model reconsiders the active bounds.
    ///
    /// Such models are indefinite more often, and their steps are shorter.
    pub(super) weighs_bounds: bool,
    /// True if the trial is on a bound of each variable.
    pub(super) stopped: Vec<bool>,
    /// Gradient ∇L, and its projection onto the free directions.
    pub(super) slope: Vec<f64>,
    left: Vec<f64>,
    /// Weights of the gradients of all rows in ∇L, and of the inequalities.
    pub(super) weights: Vec<f64>,
    pub(super) edges: Vec<f64>,
    pub(super) differences: SlopeDifferences,
    pub(super) model: TangentNewton,
}

impl NewtonWorkspace {
    /// Resizes for a number of variables, rows of a level and those above it, and inequalities.
    pub(super) fn fit(&mut self, variables: usize, rows: usize, edges: usize) {
        self.pinned.resize(variables, false);
        self.resting.resize(variables, false);
        self.stopped.resize(variables, false);
        self.slope.resize(variables, 0.0);
        self.left.resize(variables, 0.0);
        self.weights.resize(rows, 0.0);
        self.edges.resize(edges, 0.0);
        self.differences.fit(variables, rows);
        self.above.reserve(variables, variables);
        self.model.reserve(variables);
    }
}

/// Result of the steps of one model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Tried {
    Gained,
    /// The predicted decrease is hidden by rounding; `settles`: whether the cost stays the same within rounding.
    Hidden {
        settles: bool,
    },
    Nothing,
}

impl Tried {
    /// Returns whether the descent continues from the trial.
    fn moves(self) -> bool {
        matches!(self, Self::Gained | Self::Hidden { settles: true })
    }
}

impl Descent {
    /// Descends until the level is reached or has converged.
    pub(super) fn by_newton(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        Steps { steps, .. }: Steps,
        observer: &mut dyn Observer,
    ) -> Descended {
        let question = descent.question;
        let limit = steps.min(descent.stopping.max_iterations());
        let (mut iterations, mut moved, mut dampings) = (0, 0.0, [None; 2]);
        let end = |iterations, cut| Descended { iterations, cut };
        (self.newton.weighs_bounds, self.newton.has_stepped) = (true, false);
        loop {
            let cost = self.cost_at_x(descent);
            if !cost.is_finite() {
                return end(iterations, Some(Termination::NonFinite));
            }
            let weighs = usize::from(self.newton.weighs_bounds);
            let seen = observer.observe(&Iteration {
                index: iterations,
                cost,
                projected_gradient: None,
                step: moved,
                control: dampings[weighs].unwrap_or(0.0),
                x: &self.x,
            });
            if seen.is_break() {
                return end(iterations, Some(Termination::Cancelled));
            }
            if descent.is_late() {
                return end(iterations, Some(Termination::TimeLimit));
            }
            if self.is_reached(question.problem) || self.is_level(descent) {
                return end(iterations, None);
            }
            if iterations >= limit {
                return end(iterations, Some(Termination::IterationLimit));
            }
            iterations += 1;
            if !self.step.take_pulls(&self.jacobian, &self.pulls) {
                return end(iterations, None);
            }
            let (tried, damping) = self.go_on(descent, cost, dampings[weighs]);
            dampings[weighs] = Some(damping);
            if tried.moves() {
                // The swapped-out vector serves as a buffer.
                let way = &mut self.last_best;
                moved = question.space().distance(&self.trial, &self.x, way);
                std::mem::swap(&mut self.x, &mut self.trial);
            }
            let is_kept = self.newton.pinned != self.fixed || self.held.inequalities.any_works();
            self.newton.weighs_bounds = match tried {
                Tried::Gained => false,
                _ if weighs == 0 && is_kept => true,
                _ => return end(iterations, None),
            };
        }
    }

    /// Tries steps with increasing damping until one decreases the cost. Returns the damping for the next step.
    fn go_on(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        cost: f64,
        damping: Option<f64>,
    ) -> (Tried, f64) {
        self.take_hessian(descent);
        let stiffest = self.newton.model.stiffest();
        let more = |damping: f64| FACTOR * damping.max(LEAST_DAMPING * stiffest);
        let mut damping = damping.unwrap_or(FIRST_DAMPING * stiffest);
        for _ in 0..TRIALS {
            let Some(promised) = self.aim_newton(descent, damping) else {
                damping = more(damping);
                continue;
            };
            let won = cost - self.try_step(descent);
            // A decrease that rounding hides cannot be verified.
            if promised <= HIDDEN * cost {
                let settles = won >= -HIDDEN * cost;
                return (Tried::Hidden { settles }, damping);
            }
            let kept = won / promised;
            if kept > GOOD {
                damping /= FACTOR;
                if damping < LEAST_DAMPING * stiffest {
                    damping = 0.0;
                }
            } else if kept < POOR {
                damping = more(damping);
            }
            if won > 0.0 {
                return (Tried::Gained, damping);
            }
        }
        (Tried::Nothing, damping)
    }

    /// Computes ∇L and its projection at x. Returns whether the level has converged.
    fn is_level(&mut self, descent: &mut DescentProblem<'_, '_>) -> bool {
        let share = TaskSubset::rank(self.rank);
        descent.jacobian(share, &self.x, &mut self.jacobian);
        let newton = &mut self.newton;
        let space = descent.question.space();
        let columns = self
            .jacobian
            .as_slice()
            .chunks_exact(self.pulls.len().max(1));
        let mut longest = 0.0_f64;
        for (j, column) in columns.enumerate() {
            longest = longest.max(dot(column, column));
            let stands = !space.is_between_bounds(&self.x, j);
            let rests = !newton.has_stepped || newton.resting[j];
            newton.pinned[j] = self.fixed[j] || (stands && rests);
        }
        self.take_held(descent);
        loop {
            self.take_multipliers(descent);
            // Releases bounds that are pulled inward.
            let newton = &mut self.newton;
            let mut leaves = false;
            for (j, pinned) in newton.pinned.iter_mut().enumerate() {
                let keeps = self.fixed[j] || space.holds(&self.x, j, newton.slope[j], 0.0);
                leaves |= *pinned && !keeps;
                *pinned &= keeps;
            }
            if leaves {
                newton.above.clear();
                self.held
                    .span(descent.question.problem, &mut newton.above, &newton.pinned);
                self.held.span_working(&mut newton.above, &newton.pinned);
            }
            // The signs of the inequality multipliers may change after that.
            if !leaves || !self.held.inequalities.any_works() {
                break;
            }
        }
        let (newton, held) = (&mut self.newton, &mut self.held);
        newton.left.clone_from(&newton.slope);
        release(&mut newton.left, &newton.pinned);
        newton.above.project_out(&mut newton.left);
        let keeps = newton.pinned != self.fixed || held.inequalities.any_works();
        if newton.weighs_bounds && keeps {
            newton.above.clear();
            held.span(descent.question.problem, &mut newton.above, &self.fixed);
        }
        held.inequalities.take_out(&newton.edges, &mut newton.slope);
        let left = dot(&newton.left, &newton.left).sqrt();
        left <= LEVEL * (longest * dot(&self.pulls, &self.pulls)).sqrt()
    }
}
