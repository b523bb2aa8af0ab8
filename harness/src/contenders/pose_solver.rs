//! Default solver of kinopt, with its own restarts.

use kinopt::problem::Derivatives;
use kinopt::solver::Stopping;
use kinopt::{Solver, Workspace};

use super::method::solve_marked;
use crate::{Adapter, Answer, ProblemInstance, Trace};

/// A [`Solver`] with its own restarts.
#[derive(Debug)]
pub struct SolverAdapter {
    name: String,
    solver: Solver,
    workspace: Workspace,
}

impl SolverAdapter {
    /// A solver under a name, with the default stopping rules and the budget's time limit.
    #[must_use]
    pub fn new(name: impl Into<String>, solver: Solver) -> Self {
        Self {
            name: name.into(),
            solver,
            workspace: Workspace::new(),
        }
    }
}

impl Default for SolverAdapter {
    /// `kinopt::Solver::default()`.
    fn default() -> Self {
        Self::new("kinopt default", Solver::default())
    }
}

impl Adapter for SolverAdapter {
    fn name(&self) -> &str {
        &self.name
    }

    fn family(&self) -> &str {
        "kinopt"
    }

    fn setting(&self) -> String {
        format!("{} with its own restarts", self.solver.method())
    }

    fn routes(&self) -> &[Derivatives] {
        &Derivatives::ALL
    }

    fn solve(&mut self, instance: &ProblemInstance<'_>, trace: &Trace) -> Answer {
        let stopping = Stopping::default().with_time_limit(instance.budget.time_limit);
        let solver = self.solver.clone().with_stopping(stopping);
        solve_marked(
            &solver,
            instance,
            instance.start,
            &mut self.workspace,
            trace,
        )
    }
}
