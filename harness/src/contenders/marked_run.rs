//! argmin's executor with the time limit and the marks of the harness.

use std::time::Duration;

use argmin::core::observers::{Observe, ObserverMode};
use argmin::core::{Error, Executor, KV, OptimizationResult, Solver, State};
use kinopt::argmin_bridge::StateParameters;

use crate::Trace;

/// Marks the best variables after every iteration.
struct Watch(Trace);

impl<I: State> Observe<I> for Watch
where
    I::Param: StateParameters,
{
    fn observe_init(&mut self, _solver: &str, state: &I, _seen: &KV) -> Result<(), Error> {
        self.mark(state);
        Ok(())
    }

    fn observe_iter(&mut self, state: &I, _seen: &KV) -> Result<(), Error> {
        self.mark(state);
        Ok(())
    }
}

impl Watch {
    fn mark<I: State>(&self, state: &I)
    where
        I::Param: StateParameters,
    {
        if let Some(variables) = state.get_best_param().or_else(|| state.get_param()) {
            self.0.mark(variables.coordinates().as_slice());
        }
    }
}

/// Runs an executor for at most `time_limit`.
pub(super) fn run<P, S, I>(
    executor: Executor<P, S, I>,
    time_limit: Duration,
    trace: &Trace,
) -> Result<OptimizationResult<P, S, I>, Error>
where
    S: Solver<P, I>,
    I: State,
    I::Param: StateParameters,
{
    let executor = executor.timeout(time_limit);
    if trace.is_on() {
        executor
            .add_observer(Watch(trace.clone()), ObserverMode::Always)
            .run()
    } else {
        executor.run()
    }
}
