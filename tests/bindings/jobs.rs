//! Jobs on several threads.

use std::time::Duration;

use kinopt_bindings::jobs::{Jobs, run};

const INTERVAL: Duration = Duration::from_millis(1);

/// Squares, and an error for each job of `wrong`.
fn squares(threads: usize, wrong: &[usize]) -> Result<Vec<usize>, usize> {
    let work = |jobs: &Jobs<usize, usize>| {
        while let Some(index) = jobs.next() {
            let result = if wrong.contains(&index) {
                Err(index)
            } else {
                Ok(index * index)
            };
            jobs.finish(index, result);
        }
    };
    run(50, threads, work, (INTERVAL, |_| Ok(())))
}

#[test]
fn results_are_in_the_order_of_jobs() {
    let expected: Vec<usize> = (0..50).map(|index| index * index).collect();
    for threads in [1, 4] {
        assert_eq!(squares(threads, &[]), Ok(expected.clone()));
    }
}

#[test]
fn error_of_a_job_is_returned() {
    assert_eq!(squares(1, &[20, 30]), Err(20));
    assert!(squares(4, &[20, 30]).is_err());
}

#[test]
fn error_of_a_poll_ends_the_jobs() {
    let work = |jobs: &Jobs<(), &str>| {
        while let Some(index) = jobs.next() {
            std::thread::sleep(INTERVAL);
            jobs.finish(index, Ok(()));
        }
    };
    let result = run(1_000_000, 2, work, (INTERVAL, |_| Err("interrupted")));
    assert_eq!(result, Err("interrupted"));
}
