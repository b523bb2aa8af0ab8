//! The clock that limits of time look at: the system's, or one that is [given](set) where there is no system, as on
//! `wasm32-unknown-unknown`.

#[cfg(feature = "collision")]
pub(crate) mod cut_short;

use std::sync::OnceLock;
use std::time::Duration;

#[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
pub(crate) use std::time::Instant;

/// Whether a deadline is past, or the computation of this thread is to end for another reason.
#[inline]
pub(crate) fn is_past(deadline: Option<Instant>) -> bool {
    crate::interruption::is_stopped() || deadline.is_some_and(|at| Instant::now() >= at)
}

static GIVEN: OnceLock<fn() -> Duration> = OnceLock::new();

/// Gives a clock: the time since any moment. It is looked at on `wasm32-unknown-unknown` alone, where no limit of time ends
/// anything without one; the first that is given stays.
pub fn set(now: fn() -> Duration) {
    GIVEN.get_or_init(|| now);
}

#[cfg(all(target_family = "wasm", target_os = "unknown"))]
pub(crate) use given::Instant;

#[cfg(all(target_family = "wasm", target_os = "unknown"))]
mod given {
    use super::{Duration, GIVEN};

    /// A moment of the clock that was given.
    #[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
    pub struct Instant(Duration);

    impl Instant {
        pub(crate) fn now() -> Self {
            Self(GIVEN.get().map_or(Duration::ZERO, |now| now()))
        }

        pub(crate) fn checked_sub(self, time: Duration) -> Option<Self> {
            self.0.checked_sub(time).map(Self)
        }

        pub(crate) fn duration_since(self, earlier: Self) -> Duration {
            self.0.saturating_sub(earlier.0)
        }

        pub(crate) fn checked_add(self, limit: Duration) -> Option<Self> {
            self.0.checked_add(limit).map(Self)
        }
    }
}
