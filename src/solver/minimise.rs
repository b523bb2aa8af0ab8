//! The loop that all methods share: differentiate, look, stop or step.

use std::time::Instant;

use super::{Iteration, LeastSquares, Memory, Method, Observer, Step, Stopping, Termination};

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
/// `memory`. Never returns an x outside the bounds; a start that is not finite ends at once.
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
    memory.start_at(problem, start);
    let mut outcome = Outcome {
        termination: Termination::NonFinite,
        iterations: 0,
        projected_gradient: None,
    };
    if start.len() != problem.variables() || start.iter().any(|v| !v.is_finite()) {
        return outcome;
    }
    let mut last_step = Step::Taken;
    outcome.termination = loop {
        if !memory.cost.is_finite() {
            break Termination::NonFinite;
        }
        let done = problem.stops_when_reached() && problem.is_reached(&memory.residual);
        outcome.projected_gradient = None;
        if !done {
            if outcome.iterations == 0 {
                // Its size scales the gradient test, also for methods that use gradients only.
                memory.differentiate(problem);
                method.begin(memory);
            } else if last_step == Step::Taken && method.needs_jacobian() {
                memory.differentiate(problem);
            } else if last_step == Step::Taken {
                memory.differentiate_cost(problem);
            }
            outcome.projected_gradient = Some(memory.projected_gradient_norm(problem));
        }
        let seen = observer.observe(&Iteration {
            index: outcome.iterations,
            cost: memory.cost,
            projected_gradient: outcome.projected_gradient,
            step: match last_step {
                Step::Taken if outcome.iterations > 0 => memory.step_norm(),
                _ => 0.0,
            },
            damping: memory.damping,
            x: &memory.x,
        });
        let Some(projected_gradient) = outcome.projected_gradient else {
            break Termination::Reached;
        };
        if !projected_gradient.is_finite() {
            break Termination::NonFinite;
        }
        if is_stationary(projected_gradient, memory, stopping) {
            break Termination::Stationary;
        }
        if seen.is_break() {
            break Termination::Cancelled;
        }
        if outcome.iterations >= stopping.max_iterations {
            break Termination::IterationLimit;
        }
        if deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            break Termination::TimeLimit;
        }

        last_step = method.step(problem, memory);
        outcome.iterations += 1;
        let negligible = memory.step_is_negligible(stopping.step_tolerance);
        let reached = last_step == Step::Taken
            && problem.stops_when_reached()
            && problem.is_reached(&memory.residual);
        if last_step == Step::Stuck || (negligible && !reached) {
            break Termination::SmallStep;
        }
    };
    return_best(problem, memory);
    outcome
}

/// The cosine test of MINPACK (Moré 1978), with the largest column norm for every column.
fn is_stationary(projected_gradient: f64, memory: &Memory, stopping: &Stopping) -> bool {
    let length = (2.0 * memory.cost).sqrt();
    projected_gradient <= stopping.gradient_tolerance * memory.column_norm * length
}

/// A search that may climb for a while returns the best place it has seen.
fn return_best(problem: &mut dyn LeastSquares, memory: &mut Memory) {
    if memory.best_cost < memory.cost {
        memory.trial.copy_from_slice(&memory.best_x);
        let cost = memory.evaluate_trial(problem);
        memory.accept_trial(cost);
    }
}
