//! The loop that all methods share: differentiate, look, stop or step.

use std::time::Instant;

use super::search::Search;
use super::{Iteration, LeastSquares, Memory, Method, Observer, Stopping, Termination};

/// How a search ended; where, is in the memory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// Which test fired.
    pub termination: Termination,
    /// Steps tried, accepted or not.
    pub iterations: usize,
    /// ‖proj(x − g) − x‖∞ where the search ended; `None` where it was good enough to need no
    /// derivatives.
    pub projected_gradient: Option<f64>,
}

/// Searches from `start` (n numbers, projected into the bounds first) and leaves the result in
/// `memory`. Never leaves an x outside the bounds. A start of the wrong length or with a number that
/// is not finite ends at once as [`Termination::NonFinite`], standing at the bounded value next to
/// the start, where what is missing or not finite counts as zero; so does a problem whose bounds are
/// not n numbers.
pub fn minimise(
    problem: &mut dyn LeastSquares,
    method: &dyn Method,
    start: &[f64],
    stopping: &Stopping,
    observer: &mut dyn Observer,
    memory: &mut Memory,
) -> Outcome {
    minimise_until(
        problem,
        method,
        start,
        stopping,
        stopping.deadline(),
        observer,
        memory,
    )
}

/// As [`minimise`], with a deadline that several searches share.
pub(crate) fn minimise_until(
    problem: &mut dyn LeastSquares,
    method: &dyn Method,
    start: &[f64],
    stopping: &Stopping,
    deadline: Option<Instant>,
    observer: &mut dyn Observer,
    memory: &mut Memory,
) -> Outcome {
    let Some(mut search) = Search::start(problem, start, memory) else {
        return Outcome {
            termination: Termination::NonFinite,
            iterations: 0,
            projected_gradient: None,
        };
    };
    let mut milestone = (0, memory.cost);
    let termination = loop {
        if !search.look(problem, method, memory) {
            break Termination::NonFinite;
        }
        let seen = observer.observe(&Iteration {
            index: search.iterations,
            cost: memory.cost,
            projected_gradient: search.projected_gradient,
            step: search.step_norm(memory),
            damping: memory.damping,
            x: &memory.x,
        });
        if let Some(termination) = search.judge(memory, stopping) {
            break termination;
        }
        if seen.is_break() {
            break Termination::Cancelled;
        }
        if memory.cost < 0.5 * milestone.1 {
            milestone = (search.iterations, memory.cost);
        }
        let waited = search.iterations - milestone.0;
        if stopping.patience.is_some_and(|patience| waited >= patience) {
            break Termination::Stalled;
        }
        if search.iterations >= stopping.max_iterations {
            break Termination::IterationLimit;
        }
        if deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            break Termination::TimeLimit;
        }
        if let Some(termination) = search.step(problem, method, memory, stopping) {
            break termination;
        }
    };
    let projected_gradient = return_best(problem, memory).or(search.projected_gradient);
    Outcome {
        termination,
        iterations: search.iterations,
        projected_gradient,
    }
}

/// A search that may climb, or wander where the cost is flat, returns the first of the best places
/// it has seen, and the projected gradient there if it is elsewhere.
fn return_best(problem: &mut dyn LeastSquares, memory: &mut Memory) -> Option<f64> {
    if memory.best_cost > memory.cost || memory.best_x == memory.x {
        return None;
    }
    memory.trial.copy_from_slice(&memory.best_x);
    let cost = memory.evaluate_trial(problem);
    memory.accept_trial(cost);
    memory.differentiate_cost(problem);
    Some(memory.projected_gradient_norm(problem))
}
