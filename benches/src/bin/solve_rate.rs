//! Success rate, time and number of steps of each solver for five random tip targets of a skeleton from its rest
//! pose. It also measures the time of a drag of one hand along a circle.
//!
//!     cargo run --release -p kinopt-benches --bin solve_rate -- [problems]
#![allow(clippy::print_stdout)]

use std::time::Instant;

use kinopt::ik::Restarts;
use kinopt::solver::{
    Damping, FirstStep, GaussNewton, LevenbergMarquardt, ProjectedGradient, Stopping,
};
use kinopt::task::{Point, Quantity};
use kinopt::{Problem, Solver, Workspace};
use kinopt_benches::{Sequence, at_ease, drag_targets, figure, random_targets};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let problems: usize = std::env::args().nth(1).map_or(Ok(1000), |n| n.parse())?;
    let (skeleton, tips) = figure(2, 4);
    let size = skeleton.size();
    let mut builder = Problem::builder(skeleton.model());
    let tasks: Vec<_> = tips
        .iter()
        .map(|&tip| builder.add(Point::new(skeleton.tip(tip), [0.0; 3])))
        .collect();
    builder.tolerance(Quantity::Metres, 1e-8 * size);
    let problem = builder.build()?;
    let mut targets_now = problem.targets();

    // Equal targets for all solvers: tips of random poses within the full limits.
    let targets = random_targets(&skeleton, &tips, problems, &mut Sequence::new(0.5));

    println!(
        "{} bones, {} variables, {} rows, {problems} problems, tolerance 1e-8 of the size",
        skeleton.bones().len(),
        problem.variables(),
        problem.rows()
    );
    println!(
        "{:<28} {:>8} {:>9} {:>9} {:>9} {:>8} {:>8}",
        "solver", "solved", "median µs", "p99 µs", "mean µs", "steps", "tries"
    );
    let one_attempt = Restarts::none();
    let default_restarts = Restarts::default();
    let lm = |damping| LevenbergMarquardt::new(damping);
    let many_iterations = Stopping::default().with_max_iterations(2000);
    let solvers = [
        (
            "LM gain ratio, first try",
            Solver::new(lm(Damping::GainRatio)).with_restarts(one_attempt),
        ),
        (
            "LM error, first try",
            Solver::new(lm(Damping::ErrorProportional)).with_restarts(one_attempt),
        ),
        (
            "Gauss-Newton, first try",
            Solver::new(GaussNewton::default()).with_restarts(one_attempt),
        ),
        (
            "gradient BB, first try",
            Solver::new(ProjectedGradient::new(FirstStep::BarzilaiBorwein))
                .with_stopping(many_iterations)
                .with_restarts(one_attempt),
        ),
        (
            "gradient, first try",
            Solver::new(ProjectedGradient::default()).with_restarts(one_attempt),
        ),
        (
            "LM gain ratio",
            Solver::new(lm(Damping::GainRatio)).with_restarts(default_restarts),
        ),
        (
            "LM error",
            Solver::new(lm(Damping::ErrorProportional)).with_restarts(default_restarts),
        ),
        (
            "Gauss-Newton",
            Solver::new(GaussNewton::default()).with_restarts(default_restarts),
        ),
    ];
    let rest = skeleton.model().neutral();
    let mut workspace = Workspace::new();
    for (name, solver) in solvers {
        let (mut solved, mut steps, mut tries) = (0, 0, 0);
        let mut micros = Vec::with_capacity(problems);
        for target in &targets {
            for (&task, &position) in tasks.iter().zip(target) {
                targets_now.get_mut(task)?.set_target(position);
            }
            let started = Instant::now();
            let solution =
                solver.solve(problem.with_targets(&targets_now)?, &rest, &mut workspace)?;
            micros.push(started.elapsed().as_secs_f64() * 1e6);
            solved += usize::from(solution.reached);
            steps += solution.iterations;
            tries += solution.attempts;
        }
        micros.sort_by(f64::total_cmp);
        println!(
            "{name:<28} {:>7.2}% {:>9.1} {:>9.1} {:>9.1} {:>8.1} {:>8.2}",
            100.0 * solved as f64 / problems as f64,
            micros[problems / 2],
            micros[problems * 99 / 100],
            micros.iter().sum::<f64>() / problems as f64,
            steps as f64 / problems as f64,
            tries as f64 / problems as f64,
        );
    }

    // Each frame of a drag starts from the last.
    for (pose, start) in [("at ease", at_ease(&skeleton)), ("stretched out", rest)] {
        let mut q = start.clone();
        let (mut solved, mut steps) = (0, 0);
        let mut micros = Vec::new();
        for frame in 0..480 {
            let frame_targets = drag_targets(&skeleton, &tips, &start, frame);
            for (&task, &position) in tasks.iter().zip(&frame_targets) {
                targets_now.get_mut(task)?.set_target(position);
            }
            let started = Instant::now();
            let solution =
                Solver::default().solve(problem.with_targets(&targets_now)?, &q, &mut workspace)?;
            micros.push(started.elapsed().as_secs_f64() * 1e6);
            solved += usize::from(solution.reached);
            steps += solution.iterations;
            q.copy_from_slice(&solution.q);
        }
        micros.sort_by(f64::total_cmp);
        println!(
            "drag, {pose}: {solved} of 480 frames reached, median {:.1} µs, p99 {:.1} µs, \
             {:.1} steps a frame",
            micros[240],
            micros[475],
            f64::from(u32::try_from(steps)?) / 480.0,
        );
    }
    Ok(())
}
