//! A custom solver compared with those of this project, in a few lines.
//!
//! `cargo run --release -p kinopt-harness --example own_solver`
#![allow(clippy::print_stdout, clippy::expect_used)]

use std::ops::ControlFlow;

use kinopt::problem::Evaluation;
use kinopt::robot::Robot;
use kinopt::solver::LeastSquares;
use kinopt_harness::contenders::{ArgminAdapter, SolverAdapter};
use kinopt_harness::{Adapter, Answer, Bench, Budget, ProblemInstance, ProblemSet, Trace, report};

/// Moves one joint after another by a small angle in both directions, and keeps improvements.
struct CoordinateSearch;

impl Adapter for CoordinateSearch {
    fn name(&self) -> &str {
        "coordinate search"
    }

    fn solve(&mut self, instance: &ProblemInstance<'_>, trace: &Trace) -> Answer {
        let mut scratch = instance.problem.scratch();
        let mut evaluation = Evaluation::new(instance.problem, &mut scratch);
        let mut residual = vec![0.0; instance.problem.rows()];
        let mut cost = |x: &[f64]| {
            evaluation.residual(x, &mut residual);
            residual.iter().map(|r| r * r).sum::<f64>()
        };
        let mut x = vec![0.0; instance.problem.variables()];
        let map = instance.problem.parameters();
        map.reduce(instance.start, &mut x).expect("its own start");
        let (mut lowest, mut step) = (cost(&x), 0.5);
        while step > 1e-9 {
            let before = lowest;
            for joint in 0..x.len() {
                for turn in [step, -step] {
                    let mut trial = x.clone();
                    let bounds = (instance.problem.lower(), instance.problem.upper());
                    trial[joint] = (x[joint] + turn).clamp(bounds.0[joint], bounds.1[joint]);
                    let trial_cost = cost(&trial);
                    if trial_cost < lowest {
                        (x, lowest) = (trial, trial_cost);
                    }
                }
            }
            trace.mark(&instance.set.configuration(&x));
            if lowest > 0.9 * before {
                step *= 0.5;
            }
        }
        Answer::at(instance.set.configuration(&x))
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/universal_ur5e.urdf");
    let robot = Robot::read(path)?;
    let flange = robot.model().frame("flange")?;
    let set = ProblemSet::builder(&robot).point(flange).build()?;
    let set = set.with_random_cases(10, 1, None)?;

    let mut bench = Bench::new(&set, Budget::default());
    bench.add(CoordinateSearch);
    bench.add(SolverAdapter::default());
    bench.add(ArgminAdapter::lbfgs());
    let results = bench.run(&mut |_| ControlFlow::Continue(()))?;

    println!("{}", report::markdown(&results));
    let run = results
        .runs
        .iter()
        .find(|run| run.solver == "coordinate search");
    let run = run.ok_or("it took no part")?;
    assert!(run.traced && run.solved() > 0, "{} solved", run.solved());
    Ok(())
}
