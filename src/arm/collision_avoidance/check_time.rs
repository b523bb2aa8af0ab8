//! Duration of collision checks, so that a query with a time limit begins none that it cannot finish.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use super::CollisionAvoidance;
use crate::arm::arm::Arm;
use crate::arm::dispatch::Query;
use crate::clock::Instant;

/// Longest duration of recent collision checks, in nanoseconds.
#[derive(Debug, Default)]
pub(super) struct CheckTime(AtomicU64);

impl CheckTime {
    /// Runs a check, and measures it if the arm has a time limit.
    pub(super) fn measured<T>(&self, arm: &Arm, check: impl FnOnce() -> T) -> T {
        if arm.options.time_limit.is_none() {
            return check();
        }
        let begun = Instant::now();
        let result = check();
        let took = Instant::now().duration_since(begun).as_nanos() as u64;
        let before = self.0.load(Ordering::Relaxed);
        // An interruption of the process counts at most as two checks.
        let took = match before {
            0 => took,
            before => took.min(before.saturating_mul(2)),
        };
        let kept = took.max(before - before / 32);
        self.0.store(kept, Ordering::Relaxed);
        result
    }

    fn get(&self) -> Duration {
        Duration::from_nanos(self.0.load(Ordering::Relaxed))
    }
}

impl CollisionAvoidance {
    /// Returns true if a query has no time for this many more checks.
    pub(super) fn is_late(&self, query: &Query<'_>, checks: u32) -> bool {
        query.is_late_by(self.check_time.get() * checks)
    }

    /// The query with its deadline earlier by one check.
    pub(super) fn with_time_to_check<'q>(&self, query: &Query<'q>) -> Query<'q> {
        let earlier = |at: Instant| at.checked_sub(self.check_time.get()).unwrap_or(at);
        Query {
            deadline: query.deadline.map(earlier),
            ..*query
        }
    }
}
