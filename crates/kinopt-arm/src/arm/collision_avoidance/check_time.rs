//! Time that a check of all pairs takes, which a query with a time limit keeps for its report. Other checks are cut short.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use kinopt_kinematics::clock::Instant;

/// The time that is kept is at most this part of the time limit.
const RESERVED_LIMIT_DIVISOR: u128 = 3;

/// After as many checks a duration that was not reached again has shrunk to a third.
const DECAY_CHECKS: u64 = 256;

/// Longest duration of recent checks of all pairs, nanoseconds.
#[derive(Debug, Default)]
pub(super) struct CheckTime(AtomicU64);

impl CheckTime {
    /// Runs a check, and measures it if there is a time limit.
    pub(super) fn measured<T>(&self, limit: Option<Duration>, check: impl FnOnce() -> T) -> T {
        let Some(limit) = limit else {
            return check();
        };
        let start = Instant::now();
        let result = check();
        let duration = Instant::now().duration_since(start).as_nanos() as u64;
        let previous = self.0.load(Ordering::Relaxed);
        // An interruption of the process counts at most as two checks.
        let duration = match previous {
            0 => duration,
            previous => duration.min(previous.saturating_mul(2)),
        };
        let stored = duration.max(previous - previous / DECAY_CHECKS);
        // On a busy machine checks seem to take long: a search has most of its time all the same.
        let max_reserved = limit.as_nanos() / RESERVED_LIMIT_DIVISOR;
        let stored = stored.min(u64::try_from(max_reserved).unwrap_or(u64::MAX));
        self.0.store(stored, Ordering::Relaxed);
        result
    }

    pub(super) fn get(&self) -> Duration {
        Duration::from_nanos(self.0.load(Ordering::Relaxed))
    }
}
