//! Early end of long computations, for programs that handle signals.

use std::cell::Cell;

use crate::scoped_cell::with_value;

thread_local! {
    static IS_STOPPED: Cell<Option<fn() -> bool>> = const { Cell::new(None) };
}

/// Runs `work` on this thread and ends its searches, samplings and sphere covers early once `is_stopped` returns true.
///
/// `is_stopped` is called at least every few milliseconds. It must continue to return true until `work` returns. The
/// result of an interrupted `work` is incomplete: discard it. Otherwise results do not change. Threads that `work`
/// starts do not call it.
///
/// ```
/// use std::sync::atomic::{AtomicBool, Ordering};
///
/// static STOPPED: AtomicBool = AtomicBool::new(false);
/// let sum = kinopt::interruption::interruptible(|| STOPPED.load(Ordering::Relaxed), || 1 + 1);
/// assert_eq!(sum, 2);
/// ```
pub fn interruptible<T>(is_stopped: fn() -> bool, work: impl FnOnce() -> T) -> T {
    with_value(&IS_STOPPED, Some(is_stopped), work)
}

/// True if the computation of this thread is interrupted.
#[inline]
#[doc(hidden)]
pub fn is_stopped() -> bool {
    IS_STOPPED.get().is_some_and(|is_stopped| is_stopped())
}
