//! Independent jobs on several threads, while the calling thread polls.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread::{ScopedJoinHandle, park_timeout, scope};
use std::time::Duration;

/// Jobs that threads take one after another.
pub struct Jobs<T, E> {
    next: AtomicUsize,
    done: AtomicUsize,
    stopped: AtomicBool,
    results: Mutex<Vec<Option<T>>>,
    /// Error of the lowest index, independent of thread timing.
    failure: Mutex<Option<(usize, E)>>,
    total: usize,
}

impl<T: Send, E: Send> Jobs<T, E> {
    fn new(total: usize) -> Self {
        Self {
            next: AtomicUsize::new(0),
            done: AtomicUsize::new(0),
            stopped: AtomicBool::new(false),
            results: Mutex::new((0..total).map(|_| None).collect()),
            failure: Mutex::new(None),
            total,
        }
    }

    /// Index of the next job; `None` if no job is left or one has failed.
    pub fn next(&self) -> Option<usize> {
        if self.stopped.load(Ordering::Relaxed) {
            return None;
        }
        let index = self.next.fetch_add(1, Ordering::Relaxed);
        (index < self.total).then_some(index)
    }

    /// True once a job has failed: running jobs may end early.
    pub fn stopped(&self) -> &AtomicBool {
        &self.stopped
    }

    /// Stores the result of a job. An error stops all jobs.
    pub fn finish(&self, index: usize, result: Result<T, E>) {
        match result {
            Ok(result) => {
                let mut results = self.results.lock().unwrap_or_else(PoisonError::into_inner);
                results[index] = Some(result);
            }
            Err(error) => self.fail(index, error),
        }
        self.done.fetch_add(1, Ordering::Relaxed);
    }

    fn fail(&self, index: usize, error: E) {
        self.stopped.store(true, Ordering::Relaxed);
        let mut failure = self.failure.lock().unwrap_or_else(PoisonError::into_inner);
        if failure.as_ref().is_none_or(|(known, _)| index < *known) {
            *failure = Some((index, error));
        }
    }
}

/// Runs `total` jobs on threads. Each thread calls `work`, which takes jobs until none is left. Meanwhile the calling
/// thread calls `poll` with the number of finished jobs every `interval`; its error stops the jobs.
///
/// # Errors
/// The error of the lowest job, or of `poll`.
pub fn run<T: Send, E: Send>(
    total: usize,
    threads: usize,
    work: impl Fn(&Jobs<T, E>) + Sync,
    (interval, mut poll): (Duration, impl FnMut(usize) -> Result<(), E>),
) -> Result<Vec<T>, E> {
    let jobs = Jobs::new(total);
    scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(|| work(&jobs))).collect();
        while !workers.iter().all(ScopedJoinHandle::is_finished) {
            park_timeout(interval);
            if let Err(error) = poll(jobs.done.load(Ordering::Relaxed)) {
                jobs.fail(0, error);
            }
        }
    });
    let failure = jobs.failure.into_inner();
    if let Some((_, error)) = failure.unwrap_or_else(PoisonError::into_inner) {
        return Err(error);
    }
    let results = jobs.results.into_inner();
    let results = results.unwrap_or_else(PoisonError::into_inner);
    Ok(results.into_iter().flatten().collect())
}
