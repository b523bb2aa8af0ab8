//! Thread pools by number of threads.

use std::sync::{Arc, Mutex};

use pyo3::prelude::*;
use rayon::ThreadPool;

use crate::error::invalid;

/// Idle thread pool for the next call: starting sixteen threads takes half a millisecond, the time of two hundred
/// poses.
struct IdlePool {
    /// Process that started the threads: a forked process has none of them.
    process: u32,
    pool: Arc<ThreadPool>,
}

static IDLE_POOLS: Mutex<Vec<IdlePool>> = Mutex::new(Vec::new());

/// Returns a pool of `threads` threads (None: one for each core), at most as many as there are jobs and cores. Returns
/// `None` if one thread suffices.
pub(crate) fn pool(threads: Option<usize>, jobs: usize) -> PyResult<Option<Arc<ThreadPool>>> {
    let threads = count(threads, jobs)?;
    if threads <= 1 {
        return Ok(None);
    }
    // If the lock is taken, or was during a fork, this call starts a pool of its own.
    let mut idle_pools = IDLE_POOLS.try_lock().ok();
    let process = std::process::id();
    let mut pools = idle_pools.iter().flat_map(|pools| pools.iter());
    let usable = |idle_pool: &&IdlePool| {
        idle_pool.process == process && idle_pool.pool.current_num_threads() == threads
    };
    if let Some(idle_pool) = pools.find(usable) {
        return Ok(Some(Arc::clone(&idle_pool.pool)));
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = Arc::new(pool.map_err(|error| invalid(format!("threads: {error}")))?);
    if let Some(idle_pools) = &mut idle_pools {
        let pool = Arc::clone(&pool);
        idle_pools.push(IdlePool { process, pool });
    }
    Ok(Some(pool))
}

/// Number of threads: `threads` (None: one for each core), at most the number of jobs and cores.
pub(crate) fn count(threads: Option<usize>, jobs: usize) -> PyResult<usize> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    match threads {
        Some(0) => Err(invalid(
            "threads is 0, expected at least 1, or None for all cores",
        )),
        threads => Ok(threads.unwrap_or(cores).min(cores).min(jobs)),
    }
}
