//! Progress of one search in single steps, shared by the main loop and external executors.

use super::{Iterate, LeastSquares, Method, SolverState, Step, Stopping, Termination};

/// Number of flat steps in a row after which a search ends.
const MAX_FLAT_STEPS: usize = 5;

/// Stationarity below which rounding of the cost hides any decrease.
///
/// With a slope g and a curvature c, a step lowers the cost by g²/2c, which must exceed ε of the cost.
const ROUNDING_STATIONARITY: f64 = 1e-7;

/// Progress of a search; its current point is in the state.
#[derive(Clone, Copy, Debug)]
#[doc(hidden)]
pub struct Progress {
    /// Number of steps tried, accepted or not, since the search began or was resumed.
    pub(crate) iterations: usize,
    /// ‖proj(x − g) − x‖∞; `None` if x reaches the goal without derivatives.
    #[doc(hidden)]
    pub projected_gradient: Option<f64>,
    /// Quantity that is compared with [`Stopping::with_gradient_tolerance`].
    stationarity: f64,
    last_step: Step,
}

impl Progress {
    /// Begins at the projected `start`.
    ///
    /// Returns `None` for a start of the wrong length or not finite, or a problem without bounds.
    #[doc(hidden)]
    pub fn start(
        problem: &mut dyn LeastSquares,
        start: &[f64],
        state: &mut SolverState,
    ) -> Option<Self> {
        state.start_at(problem, start);
        let is_valid = start.len() == problem.variables()
            && start.iter().all(|v| v.is_finite())
            && problem.space().is_of(start.len());
        is_valid.then_some(Self {
            iterations: 0,
            projected_gradient: None,
            stationarity: f64::INFINITY,
            last_step: Step::Taken,
        })
    }

    /// Resumes a suspended search from a state with derivatives, for its next step.
    #[doc(hidden)]
    pub fn resumed(problem: &dyn LeastSquares, state: &SolverState) -> Self {
        Self {
            iterations: 0,
            projected_gradient: None,
            stationarity: state.stationarity(problem),
            last_step: Step::Refused,
        }
    }

    /// Evaluates the derivatives at x, unless they are known or x reaches the goal.
    ///
    /// Returns false if the cost is not finite.
    #[doc(hidden)]
    pub fn evaluate<M: Method>(
        &mut self,
        problem: &mut dyn LeastSquares,
        method: &M,
        method_state: &mut M::State,
        state: &mut SolverState,
    ) -> bool {
        if !state.cost.is_finite() {
            return false;
        }
        self.projected_gradient = None;
        if problem.stops_when_reached() && problem.is_reached(&state.residual) {
            return true;
        }
        if self.iterations == 0 {
            // The Jacobian's size scales the gradient test, also for methods that use gradients only.
            state.differentiate(problem);
            method.begin(method_state, state);
        } else if self.last_step == Step::Taken && method.needs_jacobian() {
            state.differentiate(problem);
        } else if self.last_step == Step::Taken {
            state.differentiate_cost(problem);
        }
        self.projected_gradient = Some(state.projected_gradient_norm(problem));
        self.stationarity = state.stationarity(problem);
        true
    }

    /// Termination of the search at its current point, if any.
    #[doc(hidden)]
    pub fn termination(&self, state: &SolverState, stopping: &Stopping) -> Option<Termination> {
        match self.projected_gradient {
            // `evaluate` evaluates no derivatives if the goal is reached, and only then.
            None => Some(Termination::Reached),
            Some(norm) if !norm.is_finite() => Some(Termination::NonFinite),
            Some(_) if self.stationarity <= stopping.gradient_tolerance => {
                Some(Termination::Stationary)
            }
            Some(_) if state.flat_steps >= MAX_FLAT_STEPS => Some(self.no_progress_termination()),
            Some(_) => None,
        }
    }

    /// Tries one step. Returns a termination if no further step is useful.
    #[doc(hidden)]
    pub fn step<M: Method>(
        &mut self,
        problem: &mut dyn LeastSquares,
        method: &M,
        method_state: &mut M::State,
        state: &mut SolverState,
        stopping: &Stopping,
    ) -> Option<Termination> {
        let mut iterate = Iterate {
            problem: &mut *problem,
            state: &mut *state,
        };
        self.last_step = method.step(method_state, &mut iterate);
        self.iterations += 1;
        // A small step that reached the goal does not end the search here: the next `evaluate` finds that.
        let is_negligible = state.step_is_negligible(stopping.step_tolerance);
        let is_reached = self.last_step == Step::Taken
            && problem.stops_when_reached()
            && problem.is_reached(&state.residual);
        let has_ended = self.last_step == Step::Stuck || (is_negligible && !is_reached);
        has_ended.then(|| self.no_progress_termination())
    }

    /// Termination of a search that makes no useful step.
    fn no_progress_termination(&self) -> Termination {
        if self.stationarity <= ROUNDING_STATIONARITY {
            Termination::Stationary
        } else {
            Termination::SmallStep
        }
    }

    /// ‖Δ‖∞ of the last step, 0 for a rejected one and before the first.
    #[doc(hidden)]
    pub fn step_norm(&self, state: &SolverState) -> f64 {
        match self.last_step {
            Step::Taken if self.iterations > 0 => state.step_norm(),
            _ => 0.0,
        }
    }
}

/// Slope along one variable that counts as zero: the fraction of s ‖r‖ that ends a search.
#[doc(hidden)]
pub fn negligible_slope(column_norm: f64, cost: f64, stopping: &Stopping) -> f64 {
    stopping.gradient_tolerance * column_norm * (2.0 * cost).sqrt()
}
