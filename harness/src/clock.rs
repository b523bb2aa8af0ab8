//! Clock of the measurements.

use std::time::Duration;

/// Description of the clock.
#[cfg(target_os = "linux")]
pub(crate) const NAME: &str = "processor time of the solver's thread";
#[cfg(not(target_os = "linux"))]
pub(crate) const NAME: &str = "wall clock";

/// Processor time of this thread, which excludes other programs.
#[cfg(target_os = "linux")]
pub(crate) fn now() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    let seconds = u64::try_from(time.tv_sec).unwrap_or(0);
    Duration::new(seconds, u32::try_from(time.tv_nsec).unwrap_or(0))
}

/// Wall clock, on systems without a processor time clock.
#[cfg(not(target_os = "linux"))]
pub(crate) fn now() -> Duration {
    static FIRST: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    FIRST.get_or_init(std::time::Instant::now).elapsed()
}

/// Runs a function and measures its time.
pub(crate) fn time<T>(work: impl FnOnce() -> T) -> (T, Duration) {
    let started = now();
    let result = work();
    (result, now().saturating_sub(started))
}
