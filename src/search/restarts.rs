//! Number and starts of attempts.
//!
//! Attempt 0 starts at the caller's start. The start of attempt i > 0 depends on (seed, i) only, so attempts are
//! independent of their order. The attempt of the lowest index that succeeds is returned. With a free base later
//! attempts may start at the end of an earlier one: see `basin_hopping.rs`.

use crate::bad_option::{AT_LEAST_ONE, BadOption};
use crate::problem::{ProblemInstance, TaskSubset};
use crate::random::RandomStream;

/// Fraction of the distance to a random configuration by which a start is perturbed. Rest poses of rigs are singular:
/// with a bend of 0 both twists coincide, and a small perturbation resolves it.
const PERTURBATION_FRACTION: f64 = 0.15;

/// Number of attempts after the first that change only the variables of unreached tasks.
const LOCAL_ATTEMPTS: usize = 2;

/// Default number of attempts.
const DEFAULT_ATTEMPTS: usize = 32;
/// Excess of variables over rows of the required tasks below which a problem with a free base has few solutions. Each
/// is on one branch of every limb.
const FEW_SOLUTIONS_EXCESS: usize = 4;
/// Default number of attempts for a problem with a free base and few solutions.
const FREE_BASE_ATTEMPTS: usize = 512;

/// Interval of the attempts that sample a free base anywhere; the others perturb it.
const BASE_SAMPLING_INTERVAL: usize = 4;

/// Number of attempts, and the seed of their starts.
///
/// The first attempt uses the caller's start. If the error of every required task is at most 1 rad there, the attempt
/// runs until it converges. A solution that it reaches is returned. For metres, a quarter of the model's reach
/// corresponds to one radian.
///
/// With larger errors the first attempt ends when it stalls, and other attempts follow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Restarts {
    /// `None` for the default number of the problem.
    attempts: Option<usize>,
    pub(super) seed: u64,
    pub(super) agreeing: Option<usize>,
    pub(super) steps: usize,
}

impl Default for Restarts {
    /// Seed 0, no limit of steps, and up to 32 attempts. A problem with a free base gets up to 512 if its variables
    /// exceed the rows of its required tasks by less than 4. An example is both feet and both hands of a robot with
    /// short arms.
    fn default() -> Self {
        Self {
            attempts: None,
            seed: 0,
            agreeing: None,
            steps: usize::MAX,
        }
    }
}

impl Restarts {
    /// A single attempt from the caller's start.
    #[must_use]
    pub fn none() -> Self {
        Self {
            attempts: Some(1),
            ..Self::default()
        }
    }

    /// Sets the largest number of attempts, including that from the caller's start; at least 1.
    #[must_use]
    pub fn with_attempts(mut self, attempts: usize) -> Self {
        self.attempts = Some(attempts);
        self
    }

    /// Sets the seed of all random starts.
    #[must_use]
    pub fn with_seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// Sets the number of agreeing attempts that end the search, at least 1. Attempts agree if their costs are
    /// within a thousandth of the lowest; the target is then most likely out of reach.
    ///
    /// Except for the first eight, attempts then run until they converge, which takes longer for unreached targets
    /// and comes slightly nearer. By default this applies only to problems with soft tasks, with 3 agreeing
    /// attempts.
    #[must_use]
    pub fn with_agreeing(mut self, agreeing: usize) -> Self {
        self.agreeing = Some(agreeing);
        self
    }

    /// Sets the total number of steps after which no new attempt starts. One continuation of the best attempt may
    /// follow, if that attempt ended early.
    #[must_use]
    pub fn with_steps(mut self, steps: usize) -> Self {
        self.steps = steps;
        self
    }

    /// Checks the ranges of both numbers of attempts.
    pub(crate) fn check(&self) -> Result<(), BadOption> {
        let agreeing = self.agreeing.unwrap_or(1);
        let attempts = self.attempts.unwrap_or(DEFAULT_ATTEMPTS);
        BadOption::check("attempts", attempts as f64, AT_LEAST_ONE)?;
        BadOption::check("agreeing", agreeing as f64, AT_LEAST_ONE)
    }

    /// Number of attempts for a problem.
    pub(super) fn attempts_for(&self, instance: ProblemInstance<'_>, subset: TaskSubset) -> usize {
        self.attempts.unwrap_or_else(|| {
            let problem = instance.problem;
            let variable_limit = problem.rows_of(subset) + FEW_SOLUTIONS_EXCESS;
            match problem.has_free_joint() && problem.variables() < variable_limit {
                true => FREE_BASE_ATTEMPTS,
                false => DEFAULT_ATTEMPTS,
            }
        })
    }

    /// Writes the start of attempt `index`. Odd attempts perturb the caller's start towards a random configuration,
    /// even ones use the random configuration. The first attempts change only `local` variables, later ones all
    /// variables that move a task.
    pub(super) fn start_of(
        &self,
        index: usize,
        start: &[f64],
        local: &[bool],
        instance: ProblemInstance<'_>,
        x: &mut [f64],
    ) {
        x.copy_from_slice(start);
        if index == 0 {
            return;
        }
        let mut random = RandomStream::new(self.seed, index as u64);
        let fraction = if index % 2 == 1 {
            PERTURBATION_FRACTION
        } else {
            1.0
        };
        for (j, value) in x.iter_mut().enumerate() {
            let (low, high) = instance.sampling_range(j, start[j]);
            let sample = low + (high - low) * random.unit();
            // The caller's pose of a free base is usually a better guess than a sample.
            let fraction = match instance.problem.is_base_variable(j)
                && !index.is_multiple_of(BASE_SAMPLING_INTERVAL)
            {
                true => PERTURBATION_FRACTION * fraction,
                false => fraction,
            };
            if local[j] || (index > LOCAL_ATTEMPTS && instance.problem.moves_a_task(j)) {
                *value = start[j] + fraction * (sample - start[j]);
            }
        }
    }
}
