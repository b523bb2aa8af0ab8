//! Promise: results do not depend on the run, on the number of threads, or on computations in other threads.

use rayon::prelude::*;

use super::AREAS;
use super::record::Case;

/// Lines of all cases, each case on any thread of a pool.
fn lines(threads: usize) -> Vec<Vec<String>> {
    let cases: Vec<&Case> = AREAS.iter().copied().flatten().collect();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    let work = || cases.par_iter().map(|case| case.lines()).collect();
    pool.build().unwrap().install(work)
}

#[test]
fn threads_and_runs_give_equal_values() {
    let [one, three] = [1, 3].map(lines);
    for (case, (one, three)) in AREAS.iter().copied().flatten().zip(one.iter().zip(&three)) {
        assert_eq!(one, three, "{}", case.name);
    }
}
