//! Thread-local value during a call.

use std::cell::Cell;
use std::thread::LocalKey;

/// Runs `work` with `value` in a cell of this thread, and restores the earlier value afterwards, also after a panic.
pub(crate) fn with_value<T: Copy, R>(
    cell: &'static LocalKey<Cell<T>>,
    value: T,
    work: impl FnOnce() -> R,
) -> R {
    let _restored = Restored(cell, cell.replace(value));
    work()
}

struct Restored<T: Copy + 'static>(&'static LocalKey<Cell<T>>, T);

impl<T: Copy> Drop for Restored<T> {
    fn drop(&mut self) {
        self.0.set(self.1);
    }
}
