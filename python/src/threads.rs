//! Threads by number.

use pyo3::prelude::*;
use rayon::ThreadPool;

use crate::error::invalid;

/// A pool of so many threads (None: one a core), or none where one is asked for.
pub(crate) fn pool(threads: Option<usize>) -> PyResult<Option<ThreadPool>> {
    if threads == Some(1) {
        return Ok(None);
    }
    if threads == Some(0) {
        return Err(invalid("threads is 0: at least 1, or None for all cores"));
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0));
    pool.build()
        .map(Some)
        .map_err(|error| invalid(format!("threads: {error}")))
}
