//! Termination criteria and reasons of a search.

use std::fmt;
use std::time::Duration;

use crate::bad_option::{AT_LEAST_0, BadOption};
use crate::clock::Instant;

/// Termination criteria of one search; a search returns an error for values out of range.
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
    /// Sets the largest number of steps, accepted or not. Default 200.
    #[must_use]
    pub fn with_max_iterations(mut self, iterations: usize) -> Self {
        self.max_iterations = iterations;
        self
    }

    /// Sets the gradient tolerance, at least 0. Default 1e-9.
    ///
    /// A point is stationary if ‖proj(x − g) − x‖∞ ≤ tolerance · s · ‖r‖, with s the largest column norm of J. The
    /// ratio is the cosine between r and the effect of any free variable.
    #[must_use]
    pub fn with_gradient_tolerance(mut self, tolerance: f64) -> Self {
        self.gradient_tolerance = tolerance;
        self
    }

    /// Sets the step tolerance, at least 0. Default 1e-15.
    ///
    /// A search ends if no variable moves by more than tolerance · max(1, |x|).
    #[must_use]
    pub fn with_step_tolerance(mut self, tolerance: f64) -> Self {
        self.step_tolerance = tolerance;
        self
    }

    /// Sets the number of steps without halving the cost after which a search ends as stalled. Default: none.
    ///
    /// Without it a search continues until it is stationary.
    #[must_use]
    pub fn with_patience(mut self, steps: Option<usize>) -> Self {
        self.patience = steps;
        self
    }

    /// Sets a wall-clock limit, checked before every step. Results then depend on the machine.
    #[must_use]
    pub fn with_time_limit(mut self, limit: Duration) -> Self {
        self.time_limit = Some(limit);
        self
    }

    /// Largest number of steps of one search.
    #[must_use]
    pub fn max_iterations(&self) -> usize {
        self.max_iterations
    }

    /// Number of steps without halving the cost after which a search ends, if set.
    #[must_use]
    pub fn patience(&self) -> Option<usize> {
        self.patience
    }

    /// Fraction of the gradient's scale that counts as stationary.
    #[must_use]
    pub fn gradient_tolerance(&self) -> f64 {
        self.gradient_tolerance
    }

    /// Relative step that counts as zero.
    #[must_use]
    pub fn step_tolerance(&self) -> f64 {
        self.step_tolerance
    }

    /// Wall-clock limit, if set.
    #[must_use]
    pub fn time_limit(&self) -> Option<Duration> {
        self.time_limit
    }

    /// Checks that both tolerances are in their ranges.
    pub(crate) fn check(&self) -> Result<(), BadOption> {
        BadOption::check("gradient_tolerance", self.gradient_tolerance, AT_LEAST_0)?;
        BadOption::check("step_tolerance", self.step_tolerance, AT_LEAST_0)
    }

    /// The same criteria with at most this patience.
    pub(crate) fn with_max_patience(self, steps: usize) -> Self {
        let patience = self.patience.map_or(steps, |limit| limit.min(steps));
        self.with_patience(Some(patience))
    }

    pub(crate) fn deadline(&self) -> Option<Instant> {
        // A limit beyond the range of the clock counts as none.
        let now = self
            .time_limit
            .map(|limit| Instant::now().checked_add(limit));
        now.flatten()
    }
}

/// Reason for the end of a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(
    any(feature = "argmin", feature = "serde"),
    derive(serde::Serialize, serde::Deserialize)
)]
#[non_exhaustive]
pub enum Termination {
    /// Every goal is within its tolerance.
    Reached,
    /// No free variable can lower the cost: usually a local minimum within the bounds. There may be lower ones
    /// elsewhere.
    Stationary,
    /// Steps became too small to change x or, over several steps, the cost.
    SmallStep,
    /// Progress became too slow for the given patience.
    Stalled,
    /// The search made the largest number of steps.
    IterationLimit,
    /// The wall-clock limit ended the search.
    ///
    /// A solution that is reached is valid. The limit then ended the comparison of several, or the descent of the soft
    /// tasks.
    TimeLimit,
    /// No attempt found a solution within the largest motion from the start. There may still be one.
    ///
    /// The result is the closest pose reached from the start.
    CannotContinue,
    /// The observer cancelled the search.
    Cancelled,
    /// The residual or its derivative is NaN or infinite, or the start is, or the start has the wrong length.
    NonFinite,
}

impl Termination {
    /// Returns true if the search ended because no nearby point is better.
    pub(crate) fn is_settled(self) -> bool {
        matches!(self, Self::Stationary | Self::SmallStep)
    }

    /// Returns true if a search was ended from outside.
    pub(crate) fn is_cut(self) -> bool {
        matches!(self, Self::Cancelled | Self::TimeLimit)
    }

    /// Name used in files and messages.
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
