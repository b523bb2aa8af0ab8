//! Working memory for calls from many threads at once.

use std::sync::{Mutex, PoisonError};

/// Copies of one thing, each lent to one call at a time.
pub(crate) struct Pool<T> {
    template: T,
    free: Mutex<Vec<T>>,
}

impl<T: Clone> Pool<T> {
    pub(crate) fn new(template: T) -> Self {
        let free = Mutex::new(Vec::new());
        Self { template, free }
    }

    /// What is copied.
    pub(crate) fn template(&self) -> &T {
        &self.template
    }

    /// Runs something with a copy of its own.
    pub(crate) fn with<R>(&self, run: impl FnOnce(&mut T) -> R) -> R {
        let free = || self.free.lock().unwrap_or_else(PoisonError::into_inner);
        let taken = free().pop();
        let mut copy = taken.unwrap_or_else(|| self.template.clone());
        let result = run(&mut copy);
        free().push(copy);
        result
    }
}
