//! Ctrl-C during long computations of the library.

use std::cell::Cell;
use std::time::{Duration, Instant};

use kinopt::interruption;
use pyo3::prelude::*;

use crate::problem::{is_raised, raise_later, raised};

/// Time between two checks for signals.
const SIGNAL_CHECK_INTERVAL: Duration = Duration::from_millis(5);
/// Calls between two reads of the clock, which costs more than the rest of a call.
const CALLS_PER_CLOCK_READ: u32 = 16;

thread_local! {
    static CALL_COUNT: Cell<u32> = const { Cell::new(0) };
    static NEXT_CHECK: Cell<Option<Instant>> = const { Cell::new(None) };
}

/// Runs `work` without the GIL. If a signal handler raises, the work stops and its exception is raised.
pub(crate) fn interruptible<T: Send>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    let done = py.detach(|| interruption::interruptible(is_stopped, work));
    raised()?;
    Ok(done)
}

fn is_stopped() -> bool {
    let called = CALL_COUNT.get().wrapping_add(1);
    CALL_COUNT.set(called);
    if !called.is_multiple_of(CALLS_PER_CLOCK_READ) {
        return is_raised();
    }
    let now = Instant::now();
    if NEXT_CHECK.get().is_none_or(|next| now >= next) {
        if let Err(error) = Python::attach(|py| py.check_signals()) {
            raise_later(error);
        }
        NEXT_CHECK.set(Some(now + SIGNAL_CHECK_INTERVAL));
    }
    is_raised()
}
