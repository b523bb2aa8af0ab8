//! Solver of a problem's settings.

use std::num::NonZeroU32;

use kinopt::Solver;
use kinopt::arm::Search;
use kinopt::ik::Restarts;
use kinopt::solver::Stopping;

use super::SolveSettings;
use super::methods;
use super::start::SolutionChoice;
use crate::option::solver::SolverOptions;

impl SolveSettings {
    /// Largest number of attempts, if given.
    #[must_use]
    pub fn attempts(&self) -> Option<u32> {
        self.attempts.map(NonZeroU32::get)
    }

    /// True if a setting selects the general solver.
    #[must_use]
    pub fn selects_general_solver(&self) -> bool {
        self.solver.is_some() || self.jacobian.is_some() || self.max_iterations.is_some()
    }

    /// True if a skeleton converges from its start before any search.
    #[must_use]
    pub fn settles(&self) -> bool {
        let plain =
            self.solver.is_none() && self.max_iterations.is_none() && self.max_move.is_none();
        plain && self.search != Some(SolutionChoice::One(Search::First))
    }

    /// Limits of the general solver.
    fn options(&self) -> SolverOptions {
        SolverOptions {
            max_iterations: self.max_iterations.map(u64::from),
            time_limit: self.time_limit,
            attempts: self.attempts().map(u64::from),
            seed: Some(self.rng_seed),
            ..SolverOptions::default()
        }
    }

    /// Limits of the general solver's attempts.
    #[must_use]
    pub fn stopping(&self) -> Stopping {
        self.options().stopping(Stopping::default())
    }

    /// General solver with its limits.
    #[must_use]
    pub fn general_solver(&self) -> Solver {
        let solver = self.solver.as_deref().map(methods::solver);
        let solver = solver.unwrap_or_default();
        let restarts = self.options().restarts(Restarts::default());
        solver
            .with_stopping(self.stopping())
            .with_restarts(restarts)
    }
}
