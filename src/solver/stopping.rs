//! When to stop, and why it was.

use std::fmt;
use std::time::Duration;

use crate::bad_option::{AT_LEAST_0, BadOption};
use crate::clock::Instant;

/// Limits of one search. What is asked to search refuses values out of their ranges.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Stopping {
    pub(super) max_iterations: usize,
    pub(super) gradient_tolerance: f64,
    pub(super) step_tolerance: f64,
    pub(super) time_limit: Option<Duration>,
    pub(super) patience: Option<usize>,
}

impl Default for Stopping {
    /// 200 iterations, gradient tolerance 1e-9, step tolerance 1e-15, no time limit.
    fn default() -> Self {
        Self {
            max_iterations: 200,
            gradient_tolerance: 1e-9,
            step_tolerance: 1e-15,
            time_limit: None,
            patience: None,
        }
    }
}

impl Stopping {
    setters! {
        /// At most so many steps, accepted or not.
        pub fn with_max_iterations(mut self, iterations: usize) { self.max_iterations = iterations }
        /// Stationary when ‖proj(x − g) − x‖∞ ≤ tolerance · s · ‖r‖ with s the largest column norm of
        /// J: the cosine between r and what any free variable can do about it. At least 0.
        pub fn with_gradient_tolerance(mut self, tolerance: f64) { self.gradient_tolerance = tolerance }
        /// Gives up when no variable moves by more than tolerance · max(1, |x|). At least 0.
        pub fn with_step_tolerance(mut self, tolerance: f64) { self.step_tolerance = tolerance }
        /// Gives up as stalled when so many steps in a row have not halved the cost. Without it a
        /// search goes on until it is stationary.
        pub fn with_patience(mut self, steps: Option<usize>) { self.patience = steps }
        /// Looks at the clock before every step and stops after `limit`. Results then depend on the
        /// machine.
        pub fn with_time_limit(mut self, limit: Duration) { self.time_limit = Some(limit) }
    }

    getters! {
        /// The most steps of one search.
        pub fn max_iterations(&self) -> usize = self.max_iterations;
        /// After how many steps that do not halve the cost a search gives up, if it does.
        pub fn patience(&self) -> Option<usize> = self.patience;
        /// The share of the gradient's scale that counts as stationary.
        pub fn gradient_tolerance(&self) -> f64 = self.gradient_tolerance;
        /// The relative step that counts as none.
        pub fn step_tolerance(&self) -> f64 = self.step_tolerance;
        /// The wall-clock limit, if there is one.
        pub fn time_limit(&self) -> Option<Duration> = self.time_limit;
    }

    /// Whether both tolerances are in their ranges.
    pub(crate) fn check(&self) -> Result<(), BadOption> {
        BadOption::check("gradient_tolerance", self.gradient_tolerance, AT_LEAST_0)?;
        BadOption::check("step_tolerance", self.step_tolerance, AT_LEAST_0)
    }

    /// The same limits with at most this patience.
    pub(crate) fn impatient(self, steps: usize) -> Self {
        let patience = self.patience.map_or(steps, |own| own.min(steps));
        self.with_patience(Some(patience))
    }

    pub(crate) fn deadline(&self) -> Option<Instant> {
        // A limit beyond what the clock can tell is none.
        let now = self
            .time_limit
            .map(|limit| Instant::now().checked_add(limit));
        now.flatten()
    }
}

/// Which test ended a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(
    any(feature = "argmin", feature = "serde"),
    derive(serde::Serialize, serde::Deserialize)
)]
#[non_exhaustive]
pub enum Termination {
    /// Every goal is within its tolerance.
    Reached,
    /// No free variable can lower the cost from there: a local minimum within the bounds, most often.
    /// There may be lower ones elsewhere.
    Stationary,
    /// Steps became too small to change anything: x, or over several steps the cost.
    SmallStep,
    /// Progress became too slow for the patience asked for.
    Stalled,
    /// The iteration limit.
    IterationLimit,
    /// The wall-clock limit. Of a solution that is reached: it is one, but the search that compares
    /// several, or the preferences' pull, was cut short.
    TimeLimit,
    /// No attempt came to a solution within the moves allowed from the start, which is no proof that
    /// there is none: the nearest place on the start's own way is returned.
    CannotContinue,
    /// The observer said stop.
    Cancelled,
    /// The residual or its derivative is NaN or infinite, or the start is (or is of the wrong length).
    NonFinite,
}

impl Termination {
    /// Whether a search ended because nothing better is near.
    pub(crate) fn is_settled(self) -> bool {
        matches!(self, Self::Stationary | Self::SmallStep)
    }

    /// Whether a search was ended from outside.
    pub(crate) fn is_cut(self) -> bool {
        matches!(self, Self::Cancelled | Self::TimeLimit)
    }

    /// The name used in files and messages.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Reached => "reached",
            Self::Stationary => "stationary",
            Self::SmallStep => "small_step",
            Self::Stalled => "stalled",
            Self::IterationLimit => "iteration_limit",
            Self::TimeLimit => "time_limit",
            Self::CannotContinue => "cannot_continue",
            Self::Cancelled => "cancelled",
            Self::NonFinite => "non_finite",
        }
    }
}

impl fmt::Display for Termination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
