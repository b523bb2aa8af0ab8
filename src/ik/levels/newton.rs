//! The descent of a level, or of preferences: Newton's method along what the levels above leave free.
//!
//! What is missed has a residual that stays, so that JᵀJ says little of how its cost bends along the few
//! directions that are left: the Hessian of L = ½‖r‖² + λᵀr↑ along them is taken by differences of its gradient, with
//! the multipliers λ of the levels above (Nocedal & Wright 2006, section 18.3), and damped until the model has a
//! minimum and the step keeps what it promises. Limits hold what they held last, unless it is pulled inward;
//! where nothing more is gained so, the next step weighs them all.

use super::descent::{Descended, Descent};
use super::descent_problem::DescentProblem;
use super::slope_differences::{SlopeDifferences, release};
use super::step_limits::Steps;
use crate::problem::Share;
use crate::solver::{Iteration, Observer, RowSpan, TangentNewton, Termination, dot};

/// The first damping, and the least that is more than none, as shares of the stiffest entry of the Hessian.
const FIRST_DAMPING: f64 = 1e-4;
const LEAST_DAMPING: f64 = 1e-9;
/// By how much a step that fails raises the damping, and one that keeps its promise lowers it.
const FACTOR: f64 = 5.0;
/// What a good step keeps of its promise, …
const GOOD: f64 = 0.7;
/// … and a poor one.
const POOR: f64 = 0.2;
/// Dampings tried in a row without a gain.
const TRIALS: usize = 14;
/// What a step promises, as a share of the cost, that rounding hides.
const HIDDEN: f64 = 1e-13;
/// What is left of the slope, as a share of J's length times the residual's, where nothing more is to be gained.
const LEVEL: f64 = 1e-10;

/// Room for Newton's method.
#[derive(Clone, Debug, Default)]
pub(super) struct NewtonMemory {
    pub(super) above: RowSpan,
    /// Which variables a bound holds.
    pub(super) pinned: Vec<bool>,
    /// On which bounds the last step's model came to rest, if there was one.
    pub(super) resting: Vec<bool>,
    pub(super) has_stepped: bool,
    /// Whether the next step's model weighs which bounds hold: it bends down more often then, as bounds hold what
    /// would fall, and its steps are shorter.
    pub(super) weighs_bounds: bool,
    /// With which the step came to one.
    pub(super) stopped: Vec<bool>,
    /// ∇L, and what is left of it along what is free.
    pub(super) slope: Vec<f64>,
    left: Vec<f64>,
    /// What multiplies the gradients of all rows in ∇L, and of the edges of rooms.
    pub(super) weights: Vec<f64>,
    pub(super) edges: Vec<f64>,
    pub(super) differences: SlopeDifferences,
    pub(super) model: TangentNewton,
}

impl NewtonMemory {
    /// Makes room for so many variables, and rows of a level and those above it.
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

/// What the steps of one model came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Tried {
    Gained,
    /// So little was promised that rounding hides it; whether the step is as good as where it set off.
    Hidden {
        settles: bool,
    },
    Nothing,
}

impl Tried {
    /// Whether the last trial is where it goes on.
    fn moves(self) -> bool {
        matches!(self, Self::Gained | Self::Hidden { settles: true })
    }
}

impl Descent {
    /// Goes from where it stands to where the level gains nothing more, or is reached.
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
                // What was best before is done with.
                let way = &mut self.last_best;
                moved = question.space().distance(&self.trial, &self.x, way);
                std::mem::swap(&mut self.x, &mut self.trial);
            }
            let is_kept = self.newton.pinned != self.fixed || self.held.rooms.any_works();
            self.newton.weighs_bounds = match tried {
                Tried::Gained => false,
                _ if weighs == 0 && is_kept => true,
                _ => return end(iterations, None),
            };
        }
    }

    /// Tries steps by Newton's model at x with more and more damping, until one gains; the damping for the next.
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
            // What rounding hides is taken at its word.
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

    /// Takes ∇L and its projection at x; whether it is as good as none.
    fn is_level(&mut self, descent: &mut DescentProblem<'_, '_>) -> bool {
        let share = Share::rank(self.rank);
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
            // What is pulled inward is let go.
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
            // Edges may be pulled the other way then.
            if !leaves || !self.held.rooms.any_works() {
                break;
            }
        }
        let (newton, held) = (&mut self.newton, &mut self.held);
        newton.left.clone_from(&newton.slope);
        release(&mut newton.left, &newton.pinned);
        newton.above.project_out(&mut newton.left);
        let keeps = newton.pinned != self.fixed || held.rooms.any_works();
        if newton.weighs_bounds && keeps {
            newton.above.clear();
            held.span(descent.question.problem, &mut newton.above, &self.fixed);
        }
        held.rooms.take_out(&newton.edges, &mut newton.slope);
        let left = dot(&newton.left, &newton.left).sqrt();
        left <= LEVEL * (longest * dot(&self.pulls, &self.pulls)).sqrt()
    }
}
