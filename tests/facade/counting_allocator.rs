//! Allocator of this test binary. It counts the allocations and the bytes of each thread.
#![allow(unsafe_code, reason = "a global allocator has no safe implementation")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
    static BYTES: Cell<isize> = const { Cell::new(0) };
    static MAX_BYTES: Cell<isize> = const { Cell::new(0) };
}

/// Counts `calls` allocations that change the bytes held by `change`. A thread that ends is not counted.
fn count(calls: usize, change: isize) {
    let _ = ALLOCATIONS.try_with(|n| n.set(n.get() + calls));
    let _ = BYTES.try_with(|held| {
        held.set(held.get() + change);
        let _ = MAX_BYTES.try_with(|most| most.set(most.get().max(held.get())));
    });
}

// SAFETY: every call is passed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(1, layout.size() as isize);
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count(0, -(layout.size() as isize));
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count(1, size as isize - layout.size() as isize);
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Number of allocations of this thread while `work` runs.
pub(crate) fn allocations(work: impl FnOnce()) -> usize {
    let before = ALLOCATIONS.get();
    work();
    ALLOCATIONS.get() - before
}

/// Largest number of bytes held at once by this thread while `work` runs, beyond those held before.
pub(crate) fn peak<T>(work: impl FnOnce() -> T) -> (T, isize) {
    let before = BYTES.get();
    MAX_BYTES.set(before);
    let result = work();
    (result, MAX_BYTES.get() - before)
}
