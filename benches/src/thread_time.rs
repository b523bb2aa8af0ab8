//! A clock that other programs do not disturb.

use std::time::Duration;

/// The processor time of this thread since `begun` was taken.
#[derive(Clone, Copy, Debug)]
pub struct ThreadTime(Duration);

impl ThreadTime {
    /// Starts to count.
    #[must_use]
    pub fn now() -> Self {
        Self(read())
    }

    /// Microseconds since then.
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

/// Elsewhere the time on the wall, from the first call on.
#[cfg(not(target_os = "linux"))]
fn read() -> Duration {
    static FIRST: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    FIRST.get_or_init(std::time::Instant::now).elapsed()
}
