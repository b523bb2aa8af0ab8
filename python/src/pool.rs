//! Workspaces for calls from several threads at once.

use std::sync::{Mutex, PoisonError};

/// Copies of a template, each used by one call at a time.
pub(crate) struct Pool<T> {
    template: T,
    free: Mutex<Vec<T>>,
}

impl<T: Clone> Pool<T> {
    pub(crate) fn new(template: T) -> Self {
        let free = Mutex::new(Vec::new());
        Self { template, free }
    }

    /// The template of the copies.
    pub(crate) fn template(&self) -> &T {
        &self.template
    }

    /// Runs a function with exclusive access to a copy.
    pub(crate) fn with<R>(&self, run: impl FnOnce(&mut T) -> R) -> R {
        let free = || self.free.lock().unwrap_or_else(PoisonError::into_inner);
        let taken = free().pop();
        let mut copy = taken.unwrap_or_else(|| self.template.clone());
        let result = run(&mut copy);
        free().push(copy);
        result
    }
}
