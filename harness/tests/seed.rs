//! Promise: if no clock ends a search, equal seeds give equal results, except for times; another seed gives other
//! results.
#![allow(clippy::unwrap_used)]

mod two_links;

use std::ops::ControlFlow;

use kinopt_harness::{Bench, ProblemSet, contenders};
use serde_json::Value;
use two_links::{patient, two_links};

/// Results without the parts that depend on the clock.
fn without_times(value: &mut Value) {
    match value {
        Value::Object(entries) => {
            entries.retain(|key, _| !key.starts_with("micros") && key != "late");
            entries.values_mut().for_each(without_times);
        }
        Value::Array(items) => items.iter_mut().for_each(without_times),
        _ => {}
    }
}

fn results(seed: u64) -> Value {
    let (model, tip) = two_links();
    let set = ProblemSet::builder(&model).pose(tip).build().unwrap();
    let set = set.with_random_cases(3, seed, None).unwrap();
    let mut bench = Bench::new(&set, patient(2));
    bench.extend(contenders::all());
    let results = bench.run(&mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(results.problems, 3);
    let mut value = serde_json::to_value(&results).unwrap();
    without_times(&mut value);
    value
}

#[test]
fn equal_seeds_give_equal_results() {
    let first = results(5);
    assert!(first["runs"].as_array().unwrap().len() > 20);
    assert_eq!(first, results(5));
    assert_ne!(first["runs"], results(6)["runs"]);
}
