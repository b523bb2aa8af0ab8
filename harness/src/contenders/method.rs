//! A single method of kinopt, with the restarts of the harness.

use std::ops::ControlFlow;

use kinopt::ik::Restarts;
use kinopt::problem::Derivatives;
use kinopt::solver::{Iteration, Method, Stopping};
use kinopt::{Solver, Workspace};

use crate::{Adapter, Answer, ProblemInstance, Trace, attempts};

/// A [`Method`] with the restarts of the harness.
#[derive(Debug)]
pub struct MethodAdapter {
    solver: Solver,
    steps: usize,
    workspace: Workspace,
}

impl MethodAdapter {
    /// A method with at most `steps` iterations in one attempt.
    #[must_use]
    pub fn new(method: impl Method + 'static, steps: usize) -> Self {
        Self {
            solver: Solver::new(method).with_restarts(Restarts::none()),
            steps,
            workspace: Workspace::new(),
        }
    }
}

impl Adapter for MethodAdapter {
    fn name(&self) -> &str {
        self.solver.method()
    }

    fn family(&self) -> &str {
        "kinopt"
    }

    fn setting(&self) -> String {
        format!("at most {} steps an attempt", self.steps)
    }

    fn routes(&self) -> &[Derivatives] {
        &Derivatives::ALL
    }

    fn solve(&mut self, instance: &ProblemInstance<'_>, trace: &Trace) -> Answer {
        attempts(instance, |start, _, remaining| {
            let stopping = Stopping::default()
                .with_max_iterations(self.steps)
                .with_time_limit(remaining);
            let solver = self.solver.clone().with_stopping(stopping);
            solve_marked(&solver, instance, start, &mut self.workspace, trace)
        })
    }
}

/// Runs a solver of kinopt and marks every iteration.
pub(super) fn solve_marked(
    solver: &Solver,
    instance: &ProblemInstance<'_>,
    start: &[f64],
    workspace: &mut Workspace,
    trace: &Trace,
) -> Answer {
    let solved = if trace.is_on() {
        let mut mark = |iteration: &Iteration<'_>| {
            trace.mark(iteration.x);
            ControlFlow::Continue(())
        };
        let solved = solver.solve_observed(instance.problem, start, workspace, &mut mark);
        trace.translate(|x| instance.set.configuration(x));
        solved
    } else {
        solver.solve(instance.problem, start, workspace)
    };
    match solved {
        Ok(solution) => Answer::from(solution),
        // Only for a start that is not finite or has the wrong length, which a problem set excludes.
        Err(_) => Answer::at(start.to_vec()),
    }
}
