//! Main loop of all methods: differentiate, observe, stop or step.

use super::progress::Progress;
use super::{
    AnyMethod, Iterate, Iteration, LeastSquares, Method, Observer, SolverState, Stopping,
    Termination,
};
use crate::search::SolveError;
use kinopt_kinematics::SizeMismatch;
use kinopt_kinematics::clock::{Instant, is_past};

/// Outcome of a search; the result is in the state.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Outcome {
    /// Test that ended the search.
    pub termination: Termination,
    /// Number of steps tried, accepted or not.
    pub iterations: usize,
    /// ‖proj(x − g) − x‖∞ at the end of the search; `None` if the goal was reached without derivatives.
    pub projected_gradient: Option<f64>,
}

/// Searches from `start` (n numbers, projected into the bounds first) and leaves the result in `state`.
///
/// Every x is within the bounds.
///
/// # Errors
/// Returns an error for:
/// - A setting of the method or a tolerance out of its range.
/// - A start or bounds of the wrong length.
/// - A start that is not finite.
pub fn minimise(
    problem: &mut dyn LeastSquares,
    method: &dyn AnyMethod,
    start: &[f64],
    stopping: &Stopping,
    observer: &mut dyn Observer,
    state: &mut SolverState,
) -> Result<Outcome, SolveError> {
    method.check()?;
    stopping.check()?;
    let n = problem.variables();
    SizeMismatch::check("numbers of the start", start.len(), n)?;
    SizeMismatch::check("lower bounds", problem.lower().len(), n)?;
    SizeMismatch::check("upper bounds", problem.upper().len(), n)?;
    if let Some(variable) = start.iter().position(|value| !value.is_finite()) {
        let value = start[variable];
        return Err(SolveError::VariableNotFinite { variable, value });
    }
    let deadline = stopping.deadline();
    Ok(method.minimise(problem, start, stopping, deadline, observer, state))
}

/// Main loop around the steps of a method.
///
/// It ends at the first of these:
/// 1. A cost that is not finite.
/// 2. A reached goal, a gradient that is not finite, a stationary point, or flat steps ([`Progress::termination`]).
/// 3. The observer's request.
/// 4. The end of the patience, the iteration limit, or the deadline.
/// 5. A negligible step ([`Progress::step`]).
pub(super) fn search<M: Method>(
    problem: &mut dyn LeastSquares,
    (method, method_state): (&M, &mut M::State),
    start: &[f64],
    (stopping, deadline): (&Stopping, Option<Instant>),
    observer: &mut dyn Observer,
    state: &mut SolverState,
) -> Outcome {
    method.reserve(method_state, problem.rows(), problem.variables());
    let Some(mut progress) = Progress::start(problem, start, state) else {
        return Outcome {
            termination: Termination::NonFinite,
            iterations: 0,
            projected_gradient: None,
        };
    };
    // Iteration and cost at the last halving of the cost.
    let (mut halved_at, mut halved_cost) = (0, state.cost);
    let termination = loop {
        if !progress.evaluate(problem, method, method_state, state) {
            break Termination::NonFinite;
        }
        let observation = observer.observe(&Iteration {
            index: progress.iterations,
            cost: state.cost,
            projected_gradient: progress.projected_gradient,
            step: progress.step_norm(state),
            control: method.control(method_state),
            x: &state.x,
        });
        if let Some(termination) = progress.termination(state, stopping) {
            break termination;
        }
        if observation.is_break() {
            break Termination::Cancelled;
        }
        if state.cost < 0.5 * halved_cost {
            (halved_at, halved_cost) = (progress.iterations, state.cost);
        }
        let steps_since_halving = progress.iterations - halved_at;
        if stopping
            .patience
            .is_some_and(|patience| steps_since_halving >= patience)
        {
            break Termination::Stalled;
        }
        if progress.iterations >= stopping.max_iterations {
            break Termination::IterationLimit;
        }
        if is_past(deadline) {
            break Termination::TimeLimit;
        }
        if let Some(termination) = progress.step(problem, method, method_state, state, stopping) {
            break termination;
        }
    };
    let projected_gradient = return_best(problem, state).or(progress.projected_gradient);
    Outcome {
        termination,
        iterations: progress.iterations,
        projected_gradient,
    }
}

/// Returns to the best point of the search if the search ended at a worse one.
///
/// A search may climb, or wander if the cost is flat. Returns the projected gradient at the best point if it is
/// another.
fn return_best(problem: &mut dyn LeastSquares, state: &mut SolverState) -> Option<f64> {
    if state.best_cost > state.cost || state.best_x == state.x {
        return None;
    }
    state.trial.copy_from_slice(&state.best_x);
    let mut iterate = Iterate { problem, state };
    iterate.evaluate_trial();
    iterate.accept();
    state.differentiate_cost(problem);
    Some(state.projected_gradient_norm(problem))
}
