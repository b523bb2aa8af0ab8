//! The clock that solvers are timed by.

use std::time::Duration;

/// What it measures, in words.
#[cfg(target_os = "linux")]
pub(crate) const NAME: &str = "processor time of the solver's thread";
#[cfg(not(target_os = "linux"))]
pub(crate) const NAME: &str = "wall clock";

/// The processor time of this thread: what other programs take meanwhile is not in it.
#[cfg(target_os = "linux")]
pub(crate) fn now() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    let seconds = u64::try_from(time.tv_sec).unwrap_or(0);
    Duration::new(seconds, u32::try_from(time.tv_nsec).unwrap_or(0))
}

/// Where the system's processor time is not at hand, the wall clock.
#[cfg(not(target_os = "linux"))]
pub(crate) fn now() -> Duration {
    static FIRST: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    FIRST.get_or_init(std::time::Instant::now).elapsed()
}

/// How long some work takes.
pub(crate) fn time<T>(work: impl FnOnce() -> T) -> (T, Duration) {
    let begun = now();
    let result = work();
    (result, now().saturating_sub(begun))
}
