//! Promise: results do not depend on the unit of length or on the model's placement in the world.

use std::ops::ControlFlow;

use kinopt::ik::Restarts;
use kinopt::problem::Problem;
use kinopt::solver::{
    Damping, FirstStep, GaussNewton, Iteration, LevenbergMarquardt, ProjectedGradient, Stopping,
};
use kinopt::spatial::Placement;
use kinopt::task::{FramePose, Orientation, Point, Quantity};
use kinopt::{Solver, Workspace};
use support::bones::RandomRig;
use support::random::{Random, part};
use support::trees::configuration_of;
use support::{placement, rigid};

/// Fixed first steps have a unit, so they are excluded.
fn solvers() -> Vec<Solver> {
    let once = |solver: Solver| solver.with_restarts(Restarts::none());
    vec![
        once(Solver::new(LevenbergMarquardt::new(Damping::GainRatio))),
        once(Solver::new(LevenbergMarquardt::new(
            Damping::ErrorProportional,
        ))),
        once(Solver::new(GaussNewton::default())),
        once(Solver::new(ProjectedGradient::new(
            FirstStep::BarzilaiBorwein,
        ))),
        Solver::default(),
    ]
}

/// Point tasks for three tips, a pose and an orientation, all of one configuration, with default weights and lengths in
/// `unit`.
fn problem(rig: &RandomRig, unit: f64, seed: u64) -> Problem {
    let model = rig.skeleton.model();
    let pose = configuration_of(model, &mut Random::new(seed));
    let transforms = rig.transforms(&pose);
    let mut builder = Problem::builder(model);
    builder.tolerance(Quantity::Metres, 1e-8 * unit);
    builder.tolerance(Quantity::Radians, 1e-8);
    for &tip in &rig.tips[..3] {
        let target = rig.tip(&transforms, tip);
        builder.add(Point::new(rig.skeleton.tip(tip), target));
    }
    let target_pose = |k: usize| -> Placement<f64> {
        let bone = rig.tips[k].index();
        placement(&(transforms[bone] * rig.rests[bone]))
    };
    builder.add(FramePose::new(
        rig.skeleton.tail(rig.tips[3]),
        target_pose(3),
    ));
    let turned = target_pose(4).rotation;
    builder.add(Orientation::new(rig.skeleton.tail(rig.tips[4]), turned));
    builder.build().unwrap()
}

/// Result of a solve, and the length of every step.
fn run(solver: &Solver, rig: &RandomRig, problem: &Problem) -> (Vec<f64>, bool, Vec<f64>) {
    let mut steps = Vec::new();
    let mut watch = |seen: &Iteration<'_>| {
        steps.push(seen.step);
        ControlFlow::Continue(())
    };
    let mut workspace = Workspace::new();
    let start = rig.skeleton.model().neutral();
    let solution = solver
        .solve_observed(problem, &start, &mut workspace, &mut watch)
        .unwrap();
    (solution.q.clone(), solution.reached, steps)
}

fn agree(label: &str, a: &(Vec<f64>, bool, Vec<f64>), b: &(Vec<f64>, bool, Vec<f64>)) {
    // Rounding differs from the first step and grows slowly; the first ten steps are compared.
    for (k, (one, other)) in a.2.iter().zip(&b.2).take(10).enumerate() {
        let close = (one - other).abs() <= 1e-7 * (1.0 + one.abs());
        assert!(close, "{label}: step {k} is {one} and {other}");
    }
    assert_eq!(a.1, b.1, "{label}: reached");
}

#[test]
fn units_of_length_give_equal_steps() {
    for seed in 0..4 {
        let metres = RandomRig::new(seed);
        let in_metres = problem(&metres, 1.0, seed);
        for unit in [1000.0, 0.0254] {
            let other = RandomRig::scaled(seed, unit);
            let in_other = problem(&other, unit, seed);
            for solver in solvers() {
                // Ten steps from the singular rest pose, where rounding is still small.
                let solver = solver.with_stopping(Stopping::default().with_max_iterations(10));
                let solver = solver.with_restarts(Restarts::none());
                let a = run(&solver, &metres, &in_metres);
                let b = run(&solver, &other, &in_other);
                let label = format!("rig {seed}, unit {unit}, {}", solver.method());
                agree(&label, &a, &b);
                for (one, same) in a.0.iter().zip(&b.0) {
                    assert!((one - same).abs() < 1e-7, "{label}: {one} and {same}");
                }
            }
        }
    }
}

#[test]
fn scaling_by_a_power_of_two_is_exact() {
    // Scaling by a power of two is exact, so all results are as well.
    for seed in part(0..4, 2) {
        let rig = RandomRig::new(seed);
        let in_metres = problem(&rig, 1.0, seed);
        for unit in [1024.0, 1.0 / 64.0] {
            let other = RandomRig::scaled(seed, unit);
            let in_other = problem(&other, unit, seed);
            for solver in solvers() {
                let a = run(&solver, &rig, &in_metres);
                let b = run(&solver, &other, &in_other);
                assert_eq!(a, b, "rig {seed}, unit {unit}, {}", solver.method());
            }
        }
    }
}

#[test]
fn placed_model_gives_equal_steps() {
    for seed in 0..4 {
        let mut random = Random::new(seed);
        let world_from_base = rigid(random.rotation(), random.vector(2.0));
        let original_rig = RandomRig::new(seed);
        let placed_rig = RandomRig::placed(seed, 1.0, world_from_base);
        let from_here = problem(&original_rig, 1.0, seed);
        let from_there = problem(&placed_rig, 1.0, seed);
        for solver in solvers() {
            let solver = solver.with_stopping(Stopping::default().with_max_iterations(10));
            let solver = solver.with_restarts(Restarts::none());
            let a = run(&solver, &original_rig, &from_here);
            let b = run(&solver, &placed_rig, &from_there);
            let label = format!("rig {seed}, {}", solver.method());
            agree(&label, &a, &b);
            for (one, same) in a.0.iter().zip(&b.0) {
                assert!((one - same).abs() < 1e-7, "{label}: {one} and {same}");
            }
        }
    }
}

#[test]
fn well_conditioned_results_agree_to_nine_digits() {
    // A small drag from a bent pose, which converges to a unique solution.
    for seed in 0..6 {
        let q = configuration_of(
            RandomRig::new(seed).skeleton.model(),
            &mut Random::new(seed),
        );
        let mut results = Vec::new();
        for unit in [1.0, 1000.0] {
            let rig = RandomRig::scaled(seed, unit);
            let model = rig.skeleton.model();
            let transforms = rig.transforms(&q);
            let mut builder = Problem::builder(model);
            builder.tolerance(Quantity::Metres, 1e-10 * unit);
            for &tip in &rig.tips {
                let drag = nalgebra::Vector3::new(0.01, -0.02, 0.01) * unit;
                let target = rig.tip(&transforms, tip) + drag;
                builder.add(Point::new(rig.skeleton.tip(tip), target));
            }
            let problem = builder.build().unwrap();
            let solver = Solver::default().with_restarts(Restarts::none());
            let solution = solver.solve_once(&problem, &q).unwrap();
            results.push((solution.q, solution.iterations, solution.reached));
        }
        let [a, b] = [&results[0], &results[1]];
        assert_eq!((a.1, a.2), (b.1, b.2), "rig {seed}");
        for (one, same) in a.0.iter().zip(&b.0) {
            assert!((one - same).abs() < 1e-9, "rig {seed}: {one} and {same}");
        }
    }
}

#[test]
fn rig_of_any_size_is_solved() {
    for unit in [1e-6, 1e-3, 1e3, 1e6, 1e9] {
        let mut reached = 0;
        for seed in 0..10 {
            let rig = RandomRig::scaled(seed, unit);
            let problem = problem(&rig, unit, seed);
            reached += usize::from(run(&Solver::default(), &rig, &problem).1);
        }
        assert_eq!(reached, 10, "in units of {unit} m");
    }
}
