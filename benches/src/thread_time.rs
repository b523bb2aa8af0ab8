//! Clock of the thread's processor time, independent of other programs.

use std::time::Duration;

/// Start of a measurement of this thread's processor time.
#[derive(Clone, Copy, Debug)]
pub struct ThreadTime(Duration);

impl ThreadTime {
    /// Starts a measurement.
    #[must_use]
    pub fn now() -> Self {
        Self(read())
    }

    /// Microseconds since the start.
    #[must_use]
    pub fn micros(self) -> f64 {
        read().saturating_sub(self.0).as_secs_f64() * 1e6
    }
}

#[cfg(target_os = "linux")]
fn read() -> Duration {
    use rustix::time::{ClockId, clock_gettime};
    let time = clock_gettime(ClockId::ThreadCPUTime);
    let seconds = u64::try_from(time.tv_sec).unwrap_or(0);
    Duration::new(seconds, u32::try_from(time.tv_nsec).unwrap_or(0))
}

/// Wall clock on other systems, from the first call.
#[cfg(not(target_os = "linux"))]
fn read() -> Duration {
    static FIRST: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    FIRST.get_or_init(std::time::Instant::now).elapsed()
}
