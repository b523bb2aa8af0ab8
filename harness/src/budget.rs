//! Budget of a solver for one problem.

use std::time::Duration;

/// Budget, equal for all solvers.
///
/// Results do not depend on the machine unless the time limit ends a search: set a long time limit for reproducible
/// runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// Time limit of one problem. Solvers read the wall clock; a solve that takes over a tenth longer by the measuring
    /// clock does not count as solved.
    pub time_limit: Duration,
    /// Number of starts of each solver: that of the case and, after a miss, random ones, equal for all. Solvers with
    /// restarts of their own use those.
    pub attempts: usize,
}

impl Default for Budget {
    /// 100 ms and 16 attempts.
    fn default() -> Self {
        Self {
            time_limit: Duration::from_millis(100),
            attempts: 16,
        }
    }
}

impl Budget {
    /// True if a solve that took `taken` was too late. A tenth of tolerance is allowed, because solvers read the clock
    /// between iterations only.
    #[must_use]
    pub fn is_late(&self, taken: Duration) -> bool {
        taken > self.time_limit.mul_f64(1.1)
    }
}
