//! Promise: an accuracy is reached at the first mark within it, coarser ones no later than finer ones, and none later
//! than the end.
#![allow(clippy::unwrap_used)]

mod two_links;

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use kinopt_harness::{
    Adapter, Answer, Bench, Case, ProblemInstance, ProblemSet, Trace, contenders,
};
use two_links::{patient, points, run, two_links};

/// Has an error of 0.15, then of 0.015 …, with a pause before each mark.
struct Approaches;

const PAUSE: Duration = Duration::from_millis(2);

impl Adapter for Approaches {
    fn name(&self) -> &str {
        "approaches"
    }

    fn solve(&mut self, instance: &ProblemInstance<'_>, trace: &Trace) -> Answer {
        let mut q = instance.start.to_vec();
        for step in 0..4 {
            let started = Instant::now();
            while started.elapsed() < PAUSE {
                std::hint::spin_loop();
            }
            q = vec![1.0, 0.15 * 0.1_f64.powi(step)];
            trace.mark(&q);
        }
        Answer::at(q)
    }
}

#[test]
fn accuracy_counts_from_the_time_of_its_mark() {
    let (model, tip) = two_links();
    let set = ProblemSet::builder(&model)
        .point(tip)
        .size(1.0)
        .build()
        .unwrap();
    let stretched = kinopt::kinematics::ForwardKinematics::of_frames(&model, &[tip])
        .unwrap()
        .place(&[1.0, 0.0])
        .unwrap()[0];
    let case = Case {
        targets: vec![stretched],
        start: vec![0.0, 0.0],
    };
    let results = run(&set.with_cases(vec![case]).unwrap(), Approaches);
    let record = &results.runs[0].records[0];
    assert_eq!(results.setting.accuracies.len(), 6);
    // 0.1 at the second mark, 0.01 at the third, 0.001 at the fourth, finer ones never: at two, three and four quarters
    // of the total time.
    let [tenth, hundredth, thousandth, none @ ..] = record.micros_to.as_slice() else {
        unreachable!()
    };
    assert!(none.iter().all(Option::is_none));
    assert!(tenth < hundredth && hundredth < thousandth);
    assert!(thousandth.unwrap() <= record.micros * (1.0 + 1e-12));
}

#[test]
fn accuracy_times_are_ordered_for_every_solver() {
    let set = points(4);
    let mut bench = Bench::new(&set, patient(3));
    bench.extend(contenders::all());
    let results = bench.run(&mut |_| ControlFlow::Continue(())).unwrap();
    let mut solved = 0;
    for record in results.runs.iter().flat_map(|run| &run.records) {
        let reached: Vec<f64> = record.micros_to.iter().flatten().copied().collect();
        assert!(reached.is_sorted());
        assert!(
            reached
                .iter()
                .all(|micros| *micros <= record.micros * (1.0 + 1e-12))
        );
        if record.solved {
            assert_eq!(reached.len(), results.setting.accuracies.len());
            solved += 1;
        }
    }
    assert!(solved > 100, "{solved}");
}
