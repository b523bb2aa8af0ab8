//! Threads by number.

use pyo3::prelude::*;
use rayon::ThreadPool;

use crate::error::invalid;

/// A pool of so many threads (None: one a core), or none where one is asked for.
pub(crate) fn pool(threads: Option<usize>) -> PyResult<Option<ThreadPool>> {
    if threads == Some(1) {
        return Ok(None);
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(count(threads)?);
    pool.build()
        .map(Some)
        .map_err(|error| invalid(format!("threads: {error}")))
}

/// So many threads (None: one a core).
pub(crate) fn count(threads: Option<usize>) -> PyResult<usize> {
    match threads {
        Some(0) => Err(invalid("threads is 0: at least 1, or None for all cores")),
        Some(threads) => Ok(threads),
        None => Ok(std::thread::available_parallelism().map_or(1, usize::from)),
    }
}
