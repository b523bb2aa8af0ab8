//! Clock for time limits: the system's, or the one of [`set`] on systems without, such as `wasm32-unknown-unknown`.

#[doc(hidden)]
pub mod deadline;

use std::sync::OnceLock;
use std::time::Duration;

#[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
#[doc(hidden)]
pub use std::time::Instant;

/// True if a deadline is past, or the computation of this thread is interrupted.
#[inline]
#[doc(hidden)]
pub fn is_past(deadline: Option<Instant>) -> bool {
    crate::interruption::is_stopped() || deadline.is_some_and(|time| Instant::now() >= time)
}

static CUSTOM_CLOCK: OnceLock<fn() -> Duration> = OnceLock::new();

/// Sets a clock that returns the time since an arbitrary moment.
///
/// Only `wasm32-unknown-unknown` uses it. Without it, time limits have no effect there. Only the first call has an
/// effect.
pub fn set(now: fn() -> Duration) {
    CUSTOM_CLOCK.get_or_init(|| now);
}

#[cfg(all(target_family = "wasm", target_os = "unknown"))]
#[doc(hidden)]
pub use custom_clock::Instant;

#[cfg(all(target_family = "wasm", target_os = "unknown"))]
mod custom_clock {
    use super::{CUSTOM_CLOCK, Duration};

    /// A moment of the clock that was set.
    #[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
    pub struct Instant(Duration);

    impl Instant {
        /// The present moment; the start without a clock.
        #[must_use]
        pub fn now() -> Self {
            Self(CUSTOM_CLOCK.get().map_or(Duration::ZERO, |now| now()))
        }

        /// The moment `time` earlier, if the clock reaches that far back.
        #[must_use]
        pub fn checked_sub(self, time: Duration) -> Option<Self> {
            self.0.checked_sub(time).map(Self)
        }

        /// Time since an earlier moment; zero if it is later.
        #[must_use]
        pub fn duration_since(self, earlier: Self) -> Duration {
            self.0.saturating_sub(earlier.0)
        }

        /// The moment `limit` later, if it can be represented.
        #[must_use]
        pub fn checked_add(self, limit: Duration) -> Option<Self> {
            self.0.checked_add(limit).map(Self)
        }
    }
}
