//! Promise: an interrupted bench keeps the problems that every solver has finished, and only those.
#![allow(clippy::unwrap_used)]

mod two_links;

use std::ops::ControlFlow;

use kinopt_harness::{Bench, contenders};
use two_links::{patient, points};

#[test]
fn interrupted_bench_keeps_equal_problems() {
    let set = points(6);
    let mut bench = Bench::new(&set, patient(1));
    bench.extend(contenders::all());
    let mut total = 0;
    let whole = bench.run(&mut |progress| {
        total = progress.total;
        ControlFlow::Continue(())
    });
    let a_problem = total / 6;
    assert_eq!(whole.unwrap().problems, 6);
    // Interrupts in the middle of the third problem, between the third and the fourth, and at the start.
    for (stop, kept) in [(2 * a_problem + 4, 2), (3 * a_problem, 3), (0, 0)] {
        let results = bench.run(&mut |progress| match progress.answered == stop {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        });
        let results = results.unwrap();
        assert_eq!((results.problems, results.setting.problems), (kept, 6));
        for run in &results.runs {
            assert_eq!(run.records.len(), kept, "{}", run.title());
        }
    }
}
