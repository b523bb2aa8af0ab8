//! Processor time of stages for each element: of the first run, with cold caches, and of the fastest. For machines with
//! other load, where wall-clock times are unreliable.
//!
//! `stage_times WORDS…`: the stages whose names contain all words.
#![allow(clippy::print_stdout)]

use std::error::Error;

use kinopt_benches::{ThreadTime, stages};

/// Number of runs of a stage.
const RUNS: usize = 200;

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    for stage in stages() {
        if !words.iter().all(|word| stage.name.contains(word.as_str())) {
            continue;
        }
        let mut run = stage.build()?;
        let mut time = || {
            let started = ThreadTime::now();
            run();
            started.micros() / stage.elements as f64
        };
        let first = time();
        let fastest = (1..RUNS).map(|_| time()).fold(first, f64::min);
        println!(
            "{}: {fastest:.3} us a {} ({first:.3} in the first run)",
            stage.name, stage.unit
        );
    }
    Ok(())
}
