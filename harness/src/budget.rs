//! What every solver may spend on one problem.

use std::time::Duration;

/// The same for every solver.
///
/// Answers do not depend on the machine as long as the clock ends nothing: give a long time limit
/// where runs must repeat exactly. [`Record::late`](crate::Record::late) tells where it was reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// The wall-clock limit of one problem. An answer that takes a tenth longer does not count as solved.
    pub time_limit: Duration,
    /// How many starts each solver may try: the case's own and, where that misses, random ones,
    /// the same for all. Solvers with restarts of their own use those.
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
    /// Whether an answer after `taken` came too late: solvers look at the clock between steps only,
    /// so a tenth more is let pass.
    #[must_use]
    pub fn is_late(&self, taken: Duration) -> bool {
        taken > self.time_limit.mul_f64(1.1)
    }
}
