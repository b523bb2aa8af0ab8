//! The loop that all methods share: differentiate, look, stop or step.

use super::progress::Progress;
use super::{
    AnyMethod, Iterate, Iteration, LeastSquares, Method, Observer, SolverState, Stopping,
    Termination,
};
use crate::SizeMismatch;
use crate::bad_option::BadOption;
use crate::clock::{Instant, is_past};

/// How a search ended; where, is in the state.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Outcome {
    /// Which test fired.
    pub termination: Termination,
    /// Steps tried, accepted or not.
    pub iterations: usize,
    /// ‖proj(x − g) − x‖∞ where the search ended; `None` where it was good enough to need no
    /// derivatives.
    pub projected_gradient: Option<f64>,
}

/// Why no search begins.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SearchError {
    /// A setting of the method or a tolerance out of its range.
    #[error(transparent)]
    Option(#[from] BadOption),
    /// A start, or bounds, of another length than the problem has variables.
    #[error(transparent)]
    Size(#[from] SizeMismatch),
    /// A start that is not finite.
    #[error("number {variable} of the start is {value}, which is not a finite number")]
    NotFinite {
        /// Which, from 0.
        variable: usize,
        /// The number.
        value: f64,
    },
}

/// Searches from `start` (n numbers, projected into the bounds first) and leaves the result in
/// `state`. Never leaves an x outside the bounds.
///
/// # Errors
/// A setting of the method or a tolerance out of its range; a start or bounds of the wrong length, a start that is not
/// finite.
pub fn minimise(
    problem: &mut dyn LeastSquares,
    method: &dyn AnyMethod,
    start: &[f64],
    stopping: &Stopping,
    observer: &mut dyn Observer,
    state: &mut SolverState,
) -> Result<Outcome, SearchError> {
    method.check()?;
    stopping.check()?;
    let n = problem.variables();
    SizeMismatch::check("numbers of the start", start.len(), n)?;
    SizeMismatch::check("lower bounds", problem.lower().len(), n)?;
    SizeMismatch::check("upper bounds", problem.upper().len(), n)?;
    if let Some(variable) = start.iter().position(|value| !value.is_finite()) {
        let value = start[variable];
        return Err(SearchError::NotFinite { variable, value });
    }
    let deadline = stopping.deadline();
    Ok(method.minimise(problem, start, stopping, deadline, observer, state))
}

/// The loop around a method's steps. What ends it, in this order: a cost that is not finite; the goal,
/// a gradient that is not finite or is none, or steps that hardly change the cost
/// ([`Progress::judge`]); the observer; patience; the iteration limit; the deadline; a step too small
/// to matter ([`Progress::step`]).
pub(super) fn search<M: Method>(
    problem: &mut dyn LeastSquares,
    (method, own): (&M, &mut M::State),
    start: &[f64],
    (stopping, deadline): (&Stopping, Option<Instant>),
    observer: &mut dyn Observer,
    state: &mut SolverState,
) -> Outcome {
    method.reserve(own, problem.rows(), problem.variables());
    let Some(mut progress) = Progress::start(problem, start, state) else {
        return Outcome {
            termination: Termination::NonFinite,
            iterations: 0,
            projected_gradient: None,
        };
    };
    // When the cost had last halved, and what it was.
    let (mut halved_at, mut halved_cost) = (0, state.cost);
    let termination = loop {
        if !progress.look(problem, method, own, state) {
            break Termination::NonFinite;
        }
        let seen = observer.observe(&Iteration {
            index: progress.iterations,
            cost: state.cost,
            projected_gradient: progress.projected_gradient,
            step: progress.step_norm(state),
            control: method.control(own),
            x: &state.x,
        });
        if let Some(termination) = progress.judge(state, stopping) {
            break termination;
        }
        if seen.is_break() {
            break Termination::Cancelled;
        }
        if state.cost < 0.5 * halved_cost {
            (halved_at, halved_cost) = (progress.iterations, state.cost);
        }
        let waited = progress.iterations - halved_at;
        if stopping.patience.is_some_and(|patience| waited >= patience) {
            break Termination::Stalled;
        }
        if progress.iterations >= stopping.max_iterations {
            break Termination::IterationLimit;
        }
        if is_past(deadline) {
            break Termination::TimeLimit;
        }
        if let Some(termination) = progress.step(problem, method, own, state, stopping) {
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

/// A search that may climb, or wander where the cost is flat, returns the first of the best places
/// it has seen, and the projected gradient there if it is elsewhere.
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
