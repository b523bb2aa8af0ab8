//! Promise: forward kinematics and the limits decide if a result counts as solved, independent of the solver's report.
#![allow(clippy::unwrap_used)]

mod two_links;

use std::ops::ControlFlow;
use std::time::Duration;

use kinopt_harness::{Adapter, Answer, Bench, Budget, Case, ProblemInstance, Trace};
use two_links::{points, run, two_links};

/// Returns a given configuration, and reports success.
struct Claims(fn(&ProblemInstance<'_>) -> Vec<f64>);

impl Adapter for Claims {
    fn name(&self) -> &str {
        "claims"
    }

    fn solve(&mut self, instance: &ProblemInstance<'_>, _trace: &Trace) -> Answer {
        Answer {
            reached: true,
            cost: 0.0,
            ..Answer::at((self.0)(instance))
        }
    }
}

/// Shoulder and elbow in closed form, by the law of cosines: independent of every solver here.
fn closed_form(instance: &ProblemInstance<'_>) -> Vec<f64> {
    let [x, y, _] = instance.targets[0].translation.to_array();
    let elbow = ((x * x + y * y) / 2.0 - 1.0).clamp(-1.0, 1.0).acos();
    let shoulder = |elbow: f64| y.atan2(x) - elbow.sin().atan2(1.0 + elbow.cos());
    let wrapped = |angle: f64| angle.sin().atan2(angle.cos());
    let both = [elbow, -elbow].map(|elbow| vec![wrapped(shoulder(elbow)), elbow]);
    let is_within = |q: &&Vec<f64>| q.iter().all(|angle| angle.abs() <= 2.0);
    both.iter().find(is_within).unwrap().clone()
}

#[test]
fn false_claim_is_not_solved() {
    let results = run(&points(20), Claims(|instance| instance.start.to_vec()));
    let records = &results.runs[0].records;
    assert_eq!(records.len(), 20);
    assert!(
        records
            .iter()
            .all(|record| record.claimed && !record.solved)
    );
    assert!(records.iter().all(|record| record.error.unwrap() > 1e-6));
    assert_eq!(results.runs[0].solved(), 0);
}

#[test]
fn unclaimed_solution_is_solved() {
    struct Unclaimed;
    impl Adapter for Unclaimed {
        fn name(&self) -> &str {
            "modest"
        }

        fn solve(&mut self, instance: &ProblemInstance<'_>, _trace: &Trace) -> Answer {
            Answer::at(closed_form(instance))
        }
    }
    let results = run(&points(20), Unclaimed);
    let records = &results.runs[0].records;
    assert!(
        records
            .iter()
            .all(|record| record.solved && !record.claimed)
    );
    assert!(records.iter().all(|record| record.cost.unwrap() < 1e-24));
}

#[test]
fn late_result_does_not_count() {
    struct Late;
    impl Adapter for Late {
        fn name(&self) -> &str {
            "dawdles"
        }

        fn solve(&mut self, instance: &ProblemInstance<'_>, _trace: &Trace) -> Answer {
            let started = std::time::Instant::now();
            let mut q = closed_form(instance);
            // Continues far beyond the limit on any clock.
            while started.elapsed() < Duration::from_millis(400) {
                q = closed_form(instance);
            }
            Answer::at(q)
        }
    }
    let set = points(1);
    let budget = Budget {
        time_limit: Duration::from_micros(10),
        attempts: 1,
    };
    let mut bench = Bench::new(&set, budget);
    bench.add(Late);
    let results = bench.run(&mut |_| ControlFlow::Continue(())).unwrap();
    let record = &results.runs[0].records[0];
    assert!(record.solved && record.late && !record.counts());
    assert_eq!(
        (results.runs[0].solved(), record.solved_micros()),
        (0, None)
    );
}

#[test]
fn configuration_beyond_a_limit_is_not_solved() {
    // After a full turn the tip is at an equal position.
    let beyond = |instance: &ProblemInstance<'_>| {
        let mut q = closed_form(instance);
        q[0] += std::f64::consts::TAU;
        q
    };
    let results = run(&points(20), Claims(beyond));
    for record in &results.runs[0].records {
        assert!(record.error.unwrap() < 1e-12 && !record.within_limits && !record.solved);
        assert!(record.micros_to.iter().all(Option::is_none));
    }
}

#[test]
fn limit_is_checked_exactly() {
    let (model, tip) = two_links();
    let set = kinopt_harness::ProblemSet::builder(&model)
        .point(tip)
        .build()
        .unwrap();
    let target = kinopt::kinematics::ForwardKinematics::of_frames(&model, &[tip])
        .unwrap()
        .place(&[2.0, 0.5])
        .unwrap()[0];
    let case = Case {
        targets: vec![target],
        start: vec![0.0, 0.0],
    };
    let set = set.with_cases(vec![case]).unwrap();
    let solved =
        |q: fn(&ProblemInstance<'_>) -> Vec<f64>| run(&set, Claims(q)).runs[0].records[0].clone();
    let on_limit = solved(|_| vec![2.0, 0.5]);
    assert!(on_limit.solved);
    assert_eq!(on_limit.active_limits, ["shoulder"]);
    let above = solved(|_| vec![2.0_f64.next_up(), 0.5]);
    assert!(above.error.unwrap() < 1e-12 && !above.solved);
}

#[test]
fn invalid_configuration_is_not_solved() {
    for claims in [
        Claims(|_| Vec::new()),
        Claims(|_| vec![0.0; 3]),
        Claims(|_| vec![f64::NAN; 2]),
        Claims(|_| vec![f64::INFINITY, 0.0]),
    ] {
        let results = run(&points(1), claims);
        let record = &results.runs[0].records[0];
        assert!(!record.solved && record.error.is_none() && record.cost.is_none());
        // JSON has no infinities.
        let text = serde_json::to_string(&results).unwrap();
        assert_eq!(
            serde_json::from_str::<kinopt_harness::Results>(&text).unwrap(),
            results
        );
    }
}
