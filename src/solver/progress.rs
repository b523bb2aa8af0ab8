//! The progress of one search in single steps: what the loop here and executors of others share.

use super::{Iterate, LeastSquares, Method, SolverState, Step, Stopping, Termination};

/// After so many steps in a row that hardly change the cost no further one makes sense.
const FLAT_STEPS: usize = 5;

/// A stationarity below this is lost in the rounding of the cost: where slopes are of size g and
/// curvatures of size c, a step wins g²/2c, which must be more than ε of the cost to be seen.
const ROUNDED: f64 = 1e-7;

/// How far a search has come; where it stands is in the state.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Progress {
    /// Steps tried, accepted or not, since it began or was resumed.
    pub(crate) iterations: usize,
    /// ‖proj(x − g) − x‖∞; `None` where x is good enough to need no derivatives.
    pub(crate) projected_gradient: Option<f64>,
    /// What [`Stopping::with_gradient_tolerance`] is compared with.
    stationarity: f64,
    last_step: Step,
}

impl Progress {
    /// Stands at the projected `start`. `None` for a start of the wrong length or not finite, and for
    /// a problem that lacks bounds.
    pub(crate) fn start(
        problem: &mut dyn LeastSquares,
        start: &[f64],
        state: &mut SolverState,
    ) -> Option<Self> {
        state.start_at(problem, start);
        let usable = start.len() == problem.variables()
            && start.iter().all(|v| v.is_finite())
            && problem.space().is_of(start.len());
        usable.then_some(Self {
            iterations: 0,
            projected_gradient: None,
            stationarity: f64::INFINITY,
            last_step: Step::Taken,
        })
    }

    /// A search that goes on with a step from a state that stands, derivatives included, where another was suspended.
    #[cfg(feature = "argmin")]
    pub(crate) fn resumed(problem: &dyn LeastSquares, state: &SolverState) -> Self {
        Self {
            iterations: 0,
            projected_gradient: None,
            stationarity: state.stationarity(problem),
            last_step: Step::Refused,
        }
    }

    /// Takes the derivatives at x, unless they are there or x is good enough without. Returns
    /// false where the cost is not a finite number.
    pub(crate) fn look<M: Method>(
        &mut self,
        problem: &mut dyn LeastSquares,
        method: &M,
        own: &mut M::State,
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
            // Its size scales the gradient test, also for methods that use gradients only.
            state.differentiate(problem);
            method.begin(own, state);
        } else if self.last_step == Step::Taken && method.needs_jacobian() {
            state.differentiate(problem);
        } else if self.last_step == Step::Taken {
            state.differentiate_cost(problem);
        }
        self.projected_gradient = Some(state.projected_gradient_norm(problem));
        self.stationarity = state.stationarity(problem);
        true
    }

    /// Whether the search ends where it stands.
    pub(crate) fn judge(&self, state: &SolverState, stopping: &Stopping) -> Option<Termination> {
        match self.projected_gradient {
            // `look` takes no derivatives where the goal is reached, and only there.
            None => Some(Termination::Reached),
            Some(norm) if !norm.is_finite() => Some(Termination::NonFinite),
            Some(_) if self.stationarity <= stopping.gradient_tolerance => {
                Some(Termination::Stationary)
            }
            Some(_) if state.flat_steps >= FLAT_STEPS => Some(self.out_of_steps()),
            Some(_) => None,
        }
    }

    /// Tries one step; returns a termination where no further one makes sense.
    pub(crate) fn step<M: Method>(
        &mut self,
        problem: &mut dyn LeastSquares,
        method: &M,
        own: &mut M::State,
        state: &mut SolverState,
        stopping: &Stopping,
    ) -> Option<Termination> {
        let mut iterate = Iterate {
            problem: &mut *problem,
            state: &mut *state,
        };
        self.last_step = method.step(own, &mut iterate);
        self.iterations += 1;
        // A small step that reached the goal ends nothing here: the next look finds it so.
        let negligible = state.step_is_negligible(stopping.step_tolerance);
        let reached = self.last_step == Step::Taken
            && problem.stops_when_reached()
            && problem.is_reached(&state.residual);
        let ends = self.last_step == Step::Stuck || (negligible && !reached);
        ends.then(|| self.out_of_steps())
    }

    /// Why no further step makes sense.
    fn out_of_steps(&self) -> Termination {
        if self.stationarity <= ROUNDED {
            Termination::Stationary
        } else {
            Termination::SmallStep
        }
    }

    /// ‖Δ‖∞ of the last step, 0 for a refused one and before the first.
    pub(crate) fn step_norm(&self, state: &SolverState) -> f64 {
        match self.last_step {
            Step::Taken if self.iterations > 0 => state.step_norm(),
            _ => 0.0,
        }
    }
}

/// The slope along one variable that counts as none: the share of s ‖r‖ that ends a search.
pub(crate) fn negligible_slope(column_norm: f64, cost: f64, stopping: &Stopping) -> f64 {
    stopping.gradient_tolerance * column_norm * (2.0 * cost).sqrt()
}
