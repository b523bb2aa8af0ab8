//! Geometric methods: CCD and FABRIK, with the restarts of the harness.

use std::ops::ControlFlow;
use std::time::Duration;

use kinopt::geometric::{Ccd, Fabrik, Geometric};
use kinopt::ik::Restarts;
use kinopt::solver::{Iteration, Silent, Stopping};

use crate::{Adapter, Answer, Budget, ProblemInstance, ProblemSet, Trace, attempts};

/// Sweeps of one attempt, as by default.
const MAX_SWEEPS: usize = 500;

/// A [`Geometric`] method, created with the remaining time.
pub struct GeometricAdapter {
    name: &'static str,
    method: fn(Stopping) -> Box<dyn Geometric>,
}

impl GeometricAdapter {
    /// Cyclic coordinate descent.
    #[must_use]
    pub fn ccd() -> Self {
        Self {
            name: "CCD",
            method: |stopping| {
                let ccd = Ccd::default().with_restarts(Restarts::none());
                Box::new(ccd.with_stopping(stopping))
            },
        }
    }

    /// Forward and backward reaching.
    #[must_use]
    pub fn fabrik() -> Self {
        Self {
            name: "FABRIK",
            method: |stopping| {
                let fabrik = Fabrik::default().with_restarts(Restarts::none());
                Box::new(fabrik.with_stopping(stopping))
            },
        }
    }

    fn limited(&self, remaining: Duration) -> Box<dyn Geometric> {
        let stopping = Stopping::default().with_max_iterations(MAX_SWEEPS);
        (self.method)(stopping.with_patience(Some(60)).with_time_limit(remaining))
    }
}

impl Adapter for GeometricAdapter {
    fn name(&self) -> &str {
        self.name
    }

    fn family(&self) -> &str {
        "geometric"
    }

    fn setting(&self) -> String {
        format!("at most {MAX_SWEEPS} sweeps an attempt, 60 that do not halve the cost end it")
    }

    fn prepare(&mut self, set: &ProblemSet, _budget: Budget) -> Result<(), String> {
        // Zero iterations: finds unsupported problems.
        let problem = set.problem().map_err(|error| error.to_string())?;
        let stopping = Stopping::default().with_max_iterations(0);
        let result = (self.method)(stopping).solve_question(
            (&problem).into(),
            &set.model().neutral(),
            &mut Silent,
        );
        result.map(|_| ()).map_err(|error| error.to_string())
    }

    fn solve(&mut self, instance: &ProblemInstance<'_>, trace: &Trace) -> Answer {
        attempts(instance, |start, _, remaining| {
            let method = self.limited(remaining);
            let solved = if trace.is_on() {
                let mut mark = |iteration: &Iteration<'_>| {
                    trace.mark(iteration.x);
                    ControlFlow::Continue(())
                };
                let solved = method.solve_question(instance.problem, start, &mut mark);
                trace.translate(|x| instance.set.configuration(x));
                solved
            } else {
                method.solve_question(instance.problem, start, &mut Silent)
            };
            match solved {
                Ok(solution) => Answer::from(&solution),
                // Unsupported problems were excluded before.
                Err(_) => Answer::at(start.to_vec()),
            }
        })
    }
}
