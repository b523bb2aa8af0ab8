//! Promise: a success is preferred to any failure, whatever their costs. The first restarts keep limbs that are at
//! their targets.

use std::ops::ControlFlow;

use kinopt::ik::Restarts;
use kinopt::model::{JointId, Limits, Model};
use kinopt::problem::Problem;
use kinopt::solver::{Iteration, Stopping};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{Inputs, Point, Quantity, Residual, RowBlock, Task};
use kinopt::{Scalar, Solver, Workspace};

/// One row that nearly vanishes at −2 and vanishes at 2. One row of infinite tolerance that costs more at 2 than the
/// first at −2.
#[derive(Clone)]
struct Wells(JointId);

impl Residual for Wells {
    fn inputs(&self) -> Inputs {
        Inputs::joints([self.0])
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![
            RowBlock::new(Quantity::Metres, 1),
            RowBlock::new(Quantity::Ratio, 1),
        ]
    }

    fn evaluate<S: Scalar>(&self, _: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        let (q, c) = (joints[0], S::constant);
        let left = q + c(2.0);
        residual[0] = (c(2.0) - q) * (left * left + c(4e-3)) * c(1.0 / 16.0);
        residual[1] = left * c(0.25);
    }
}

#[test]
fn success_is_preferred_to_cheaper_failure() {
    let mut builder = Model::builder("one joint");
    let z = Vector3::new(0.0, 0.0, 1.0);
    let joint = builder.revolute("q", None, Placement::identity(), z, Limits::new(-3.0, 3.0));
    let model = builder.build().unwrap();
    let mut builder = Problem::builder(&model);
    let wells = Task::new(Wells(joint)).weight(Quantity::Ratio, 0.01);
    let wells = wells.tolerance(Quantity::Ratio, f64::INFINITY);
    builder.add(wells.tolerance(Quantity::Metres, 1e-4));
    let problem = builder.build().unwrap();
    let solve = |attempts: usize| {
        let restarts = Restarts::default().with_attempts(attempts);
        let solver = Solver::default().with_restarts(restarts);
        solver.solve_once(&problem, &[-2.0]).unwrap()
    };
    let [alone, together] = [1, 32].map(solve);
    assert!(!alone.reached && alone.q[0] < -1.5, "{:?}", alone.q);
    assert!(together.reached && together.q[0] > 1.5, "{:?}", together.q);
    assert!(together.cost > 2.0 * alone.cost);
}

/// Two arms at one base: one at its target, one with an unreachable target.
#[test]
fn restarts_keep_a_reached_limb() {
    let mut builder = Model::builder("two arms");
    let (z, limits) = (Vector3::new(0.0, 0.0, 1.0), Limits::new(-2.0, 2.0));
    let link = Placement::translation([1.0, 0.0, 0.0].into());
    let mut arm = |name: &str| {
        let named = |joint: &str| format!("{name} {joint}");
        let near = builder.revolute(named("shoulder"), None, Placement::identity(), z, limits);
        let elbow = builder.revolute(named("elbow"), Some(near), link, z, limits);
        builder.frame(named("tip"), Some(elbow), link)
    };
    let [idle, busy] = ["left", "right"].map(&mut arm);
    let model = builder.build().unwrap();
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(idle, [2.0, 0.0, 0.0]));
    builder.add(Point::new(busy, [2.0, 3.0, 1.0]));
    let problem = builder.build().unwrap();
    let mut starts: Vec<Vec<f64>> = Vec::new();
    let mut watch = |step: &Iteration<'_>| {
        if step.index == 0 {
            starts.push(step.x.to_vec());
        }
        ControlFlow::Continue(())
    };
    let solver = Solver::default()
        .with_stopping(Stopping::default().with_max_iterations(1))
        .with_restarts(Restarts::default().with_attempts(6));
    let mut workspace = Workspace::new();
    solver
        .solve_observed(&problem, &[0.0; 4], &mut workspace, &mut watch)
        .unwrap();
    let moved = |start: &Vec<f64>| [&start[..2], &start[2..]].map(|arm| *arm != [0.0; 2]);
    let moved: Vec<[bool; 2]> = starts[..6].iter().map(moved).collect();
    assert_eq!(moved[0], [false; 2]);
    assert_eq!(moved[1..], [[false, true]; 5]);
}

/// Row with many minima of nearly equal cost.
#[derive(Clone)]
struct Ripples(JointId);

impl Residual for Ripples {
    fn inputs(&self) -> Inputs {
        Inputs::joints([self.0])
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Metres, 1)]
    }

    fn evaluate<S: Scalar>(&self, _: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        let (q, c) = (joints[0], S::constant);
        let (sine, _) = (q * c(20.0)).sin_cos();
        residual[0] = c(1.0) + c(0.1) * sine + c(1e-8) * q;
    }
}

/// Attempts that improve the cost by less than a millionth agree with earlier ones.
#[test]
fn marginally_nearer_miss_agrees() {
    let mut builder = Model::builder("one");
    let (at, z) = (Placement::identity(), Vector3::new(0.0, 0.0, 1.0));
    let joint = builder.revolute("joint", None, at, z, Limits::new(-3.0, 3.0));
    let model = builder.build().unwrap();
    let mut tasks = Problem::builder(&model);
    tasks.add(Ripples(joint));
    let problem = tasks.build().unwrap();
    let found = |seed: u64, agreeing: usize| {
        let restarts = Restarts::default().with_agreeing(agreeing).with_seed(seed);
        let solver = Solver::default().with_restarts(restarts);
        solver.solve_once(&problem, &[2.5]).unwrap().attempts
    };
    // Eight end early, the best of them converges, and two more agree, because every other attempt is a perturbation.
    for seed in 0..6 {
        assert_eq!(found(seed, 3), 11, "{seed}");
    }
}
