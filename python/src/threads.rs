//! Threads by number.

use std::sync::{Arc, Mutex};

use pyo3::prelude::*;
use rayon::ThreadPool;

use crate::error::invalid;

/// Threads that wait for the next call: starting sixteen takes half a millisecond, in which two hundred poses are solved.
struct Waiting {
    /// The process that started them: one that was forked off has none of them.
    process: u32,
    pool: Arc<ThreadPool>,
}

static WAITING: Mutex<Vec<Waiting>> = Mutex::new(Vec::new());

/// A pool of so many threads (None: one a core) for so many jobs, or none where one is enough. It has at most as many threads as
/// there are jobs and cores.
pub(crate) fn pool(threads: Option<usize>, jobs: usize) -> PyResult<Option<Arc<ThreadPool>>> {
    let threads = count(threads, jobs)?;
    if threads <= 1 {
        return Ok(None);
    }
    // Who finds it locked, or was forked off while it was, starts threads of its own.
    let mut waiting = WAITING.try_lock().ok();
    let process = std::process::id();
    let mut pools = waiting.iter().flat_map(|pools| pools.iter());
    let usable =
        |own: &&Waiting| own.process == process && own.pool.current_num_threads() == threads;
    if let Some(own) = pools.find(usable) {
        return Ok(Some(Arc::clone(&own.pool)));
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = Arc::new(pool.map_err(|error| invalid(format!("threads: {error}")))?);
    if let Some(waiting) = &mut waiting {
        let pool = Arc::clone(&pool);
        waiting.push(Waiting { process, pool });
    }
    Ok(Some(pool))
}

/// So many threads (None: one a core) for so many jobs, at most as many as there are jobs and cores.
pub(crate) fn count(threads: Option<usize>, jobs: usize) -> PyResult<usize> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    match threads {
        Some(0) => Err(invalid("threads is 0: at least 1, or None for all cores")),
        threads => Ok(threads.unwrap_or(cores).min(cores).min(jobs)),
    }
}
