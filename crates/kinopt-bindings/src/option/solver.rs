//! Options of a solver: limits of an attempt, and restarts.

use std::time::Duration;

use kinopt::ik::Restarts;
use kinopt::solver::Stopping;

use super::{OptionSpec, Setter};
use crate::value::{Arguments, ErrorOf};

/// Limits of a solver as given; `None` is the default of the method.
#[derive(Clone, Debug, Default)]
pub struct SolverOptions {
    /// Largest number of steps of an attempt.
    pub max_iterations: Option<u64>,
    /// Cosine between residual and Jacobian that counts as stationary.
    pub gradient_tolerance: Option<f64>,
    /// Relative step that counts as zero.
    pub step_tolerance: Option<f64>,
    /// Number of steps in which the cost must halve; the inner `None` is unlimited.
    pub patience: Option<Option<usize>>,
    /// Time limit of all attempts together.
    pub time_limit: Option<Duration>,
    /// Largest number of attempts.
    pub attempts: Option<u64>,
    /// Seed of random starts.
    pub seed: Option<u64>,
    /// Number of attempts that agree on a miss before the search ends.
    pub agreeing: Option<u64>,
    /// Total number of steps after which no new attempt starts.
    pub restart_steps: Option<u64>,
}

/// Options of a solver, by name. `patience` is read by the interface, since infinity means unlimited in some languages.
#[must_use]
pub fn options() -> [OptionSpec<SolverOptions>; 9] {
    [
        OptionSpec {
            name: "attempts",
            set: Setter::LongWhole(|options, attempts| SolverOptions {
                attempts: Some(attempts),
                ..options
            }),
            doc: "largest number of attempts, including the one from the given start, at least 1.",
            default: "32; 512 for a body on a free base with few more variables than equations",
        },
        OptionSpec {
            name: "seed",
            set: Setter::LongWhole(|options, seed| SolverOptions {
                seed: Some(seed),
                ..options
            }),
            doc: "seed of random starts.",
            default: "0",
        },
        OptionSpec {
            name: "time_limit",
            set: Setter::TimeLimit(|options, limit| SolverOptions {
                time_limit: Some(limit),
                ..options
            }),
            doc: "time limit of all attempts together, seconds; results then depend on the machine.",
            default: "none",
        },
        OptionSpec {
            name: "max_iterations",
            set: Setter::LongWhole(|options, steps| SolverOptions {
                max_iterations: Some(steps),
                ..options
            }),
            doc: "largest number of steps of an attempt.",
            default: "200; 500 sweeps of the geometric methods",
        },
        OptionSpec {
            name: "agreeing",
            set: Setter::LongWhole(|options, attempts| SolverOptions {
                agreeing: Some(attempts),
                ..options
            }),
            doc: "number of attempts that stop at the same lowest cost before the search ends, at least 1.",
            default: "all; 3 with soft tasks",
        },
        OptionSpec {
            name: "gradient_tolerance",
            set: Setter::Number(|options, tolerance| SolverOptions {
                gradient_tolerance: Some(tolerance),
                ..options
            }),
            doc: "cosine between residual and Jacobian that counts as stationary, at least 0.",
            default: "1e-9",
        },
        OptionSpec {
            name: "step_tolerance",
            set: Setter::Number(|options, tolerance| SolverOptions {
                step_tolerance: Some(tolerance),
                ..options
            }),
            doc: "relative step that counts as zero, at least 0.",
            default: "1e-15",
        },
        OptionSpec {
            name: "patience",
            set: Setter::Elsewhere,
            doc: "number of steps in which the cost must halve, at least 1.",
            default: "unlimited; 60 for the geometric methods",
        },
        OptionSpec {
            name: "restart_steps",
            set: Setter::LongWhole(|options, steps| SolverOptions {
                restart_steps: Some(steps),
                ..options
            }),
            doc: "total number of steps after which no new attempt starts. One attempt may follow.",
            default: "unlimited",
        },
    ]
}

impl SolverOptions {
    /// Reads the options except `patience`.
    ///
    /// # Errors
    /// If an option has another type.
    pub fn of<A: Arguments>(arguments: &A) -> Result<Self, ErrorOf<A>> {
        super::apply(arguments, &options(), Self::default())
    }

    /// Applies the limits of an attempt to `stopping`.
    #[must_use]
    pub fn stopping(&self, mut stopping: Stopping) -> Stopping {
        if let Some(iterations) = self.max_iterations {
            stopping = stopping.with_max_iterations(count(iterations));
        }
        if let Some(tolerance) = self.gradient_tolerance {
            stopping = stopping.with_gradient_tolerance(tolerance);
        }
        if let Some(tolerance) = self.step_tolerance {
            stopping = stopping.with_step_tolerance(tolerance);
        }
        if let Some(patience) = self.patience {
            stopping = stopping.with_patience(patience);
        }
        match self.time_limit {
            Some(limit) => stopping.with_time_limit(limit),
            None => stopping,
        }
    }

    /// Applies the limits of a search to `restarts`.
    #[must_use]
    pub fn restarts(&self, mut restarts: Restarts) -> Restarts {
        if let Some(attempts) = self.attempts {
            restarts = restarts.with_attempts(count(attempts));
        }
        if let Some(seed) = self.seed {
            restarts = restarts.with_seed(seed);
        }
        if let Some(agreeing) = self.agreeing {
            restarts = restarts.with_agreeing(count(agreeing));
        }
        match self.restart_steps {
            Some(steps) => restarts.with_steps(count(steps)),
            None => restarts,
        }
    }

    /// True if a limit of an attempt is given.
    #[must_use]
    pub fn any_of_stopping(&self) -> bool {
        let tolerances = [self.gradient_tolerance, self.step_tolerance];
        self.max_iterations.is_some()
            || self.patience.is_some()
            || self.time_limit.is_some()
            || tolerances.iter().any(Option::is_some)
    }

    /// True if a limit of a search is given.
    #[must_use]
    pub fn any_of_restarts(&self) -> bool {
        let counts = [self.attempts, self.agreeing, self.restart_steps];
        self.seed.is_some() || counts.iter().any(Option::is_some)
    }
}

/// A number of steps or attempts.
fn count(number: u64) -> usize {
    usize::try_from(number).unwrap_or(usize::MAX)
}
