//! Promise: a first step of any length, 10 000 as well as 1 000 000, is halved until the cost falls. The full step
//! would raise it.

use std::ops::ControlFlow;

use kinopt::ik::Restarts;
use kinopt::model::{Limits, Model, ParameterMap};
use kinopt::problem::{Evaluation, Problem};
use kinopt::solver::{FirstStep, Iteration, LeastSquares, ProjectedGradient, Stopping};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{Point, Quantity, Task};
use kinopt::{Solver, Workspace};
use nalgebra::DMatrix;
use support::bones::RandomRig;
use support::random::Random;
use support::trees::configuration_of;

/// Five tips with targets from another pose.
fn drag(rig: &RandomRig, seed: u64) -> (Problem, Vec<f64>) {
    let model = rig.skeleton.model();
    let mut random = Random::new(seed);
    let start = configuration_of(model, &mut random);
    let transforms = rig.transforms(&configuration_of(model, &mut random));
    let mut builder = Problem::builder(model);
    for &tip in &rig.tips {
        let target = rig.tip(&transforms, tip);
        builder.add(Point::new(rig.skeleton.tip(tip), target));
    }
    (builder.build().unwrap(), start)
}

/// E and its gradient, from the library's own problem.
fn energy(evaluation: &mut Evaluation<'_>, x: &[f64]) -> (f64, Vec<f64>) {
    let (m, n) = (evaluation.rows(), evaluation.variables());
    let (mut r, mut gradient) = (vec![0.0; m], vec![0.0; n]);
    evaluation.residual(x, &mut r);
    evaluation.gradient(x, &r, &mut gradient, &mut DMatrix::zeros(m, n));
    (0.5 * r.iter().map(|r| r * r).sum::<f64>(), gradient)
}

#[test]
fn full_steps_raise_and_small_steps_lower_cost() {
    let mut raised = 0;
    for seed in 0..10 {
        let rig = RandomRig::new(seed);
        let (_, start) = drag(&rig, seed);
        // Without limits, so that only the step length bounds the step.
        let free = ParameterMap::identity(rig.skeleton.model());
        let goal = rig.transforms(&vec![0.0; start.len()]);
        let mut builder = Problem::builder(rig.skeleton.model());
        builder.parameters(free);
        let tip = rig.tips[0];
        let near = rig.tip(&rig.transforms(&start), tip) * 0.99 + rig.tip(&goal, tip) * 0.01;
        builder.add(Point::new(rig.skeleton.tip(tip), near));
        let problem = builder.build().unwrap();
        let mut scratch = problem.scratch();
        let mut evaluation = Evaluation::new(&problem, &mut scratch);
        let (before, gradient) = energy(&mut evaluation, &start);
        let mut after = |sigma: f64| {
            let moved: Vec<f64> = start
                .iter()
                .zip(&gradient)
                .map(|(x, g)| x - sigma * g)
                .collect();
            energy(&mut evaluation, &moved).0
        };
        raised += usize::from(after(1e6) > before);
        for sigma in [1e-3, 1e-5, 1e-7] {
            assert!(
                after(sigma) < before,
                "rig {seed}: σ = {sigma} is small enough"
            );
        }
    }
    assert!(raised >= 9, "{raised} of 10");
}

#[test]
fn large_first_step_is_halved_until_cost_falls() {
    for (seed, first) in [(0, 1e4), (1, 1e4), (2, 1e6), (3, 1e6), (4, 7e9)] {
        let rig = RandomRig::new(seed);
        let (problem, start) = drag(&rig, seed);
        let mut costs: Vec<f64> = Vec::new();
        let mut watch = |seen: &Iteration<'_>| {
            costs.push(seen.cost);
            if seen.index > 0 && seen.step > 0.0 {
                // σ = first / 2^k for an integer k.
                let mut halved = first;
                while halved > seen.control {
                    halved *= 0.5;
                }
                assert_eq!(halved, seen.control);
            }
            ControlFlow::Continue(())
        };
        let method = ProjectedGradient::new(FirstStep::Fixed(first));
        let stopping = Stopping::default().with_max_iterations(60);
        let solver = Solver::new(method).with_stopping(stopping);
        let solver = solver.with_restarts(Restarts::none());
        let mut workspace = Workspace::new();
        solver
            .solve_observed(&problem, &start, &mut workspace, &mut watch)
            .unwrap();
        assert!(costs.len() > 10);
        for pair in costs.windows(2) {
            assert!(
                pair[1] <= pair[0],
                "rig {seed}: {} after {}",
                pair[1],
                pair[0]
            );
        }
        assert!(costs[costs.len() - 1] < 0.5 * costs[0]);
    }
}

/// A step that barely lowers the cost is shortened. The parabola ½ k x² is lower by 1e-4 at the opposite side and
/// minimal half way.
#[test]
fn step_of_negligible_gain_is_shortened() {
    let mut builder = Model::builder("slide");
    let axis = Vector3::new(1.0, 0.0, 0.0);
    let limits = Limits::new(-10.0, 10.0);
    let slide = builder.prismatic("slide", None, Placement::identity(), axis, limits);
    let rider = builder.frame("rider", Some(slide), Placement::identity());
    let model = builder.build().unwrap();
    let mut builder = Problem::builder(&model);
    // Steps start at 10⁴ and are halved: the 13th is 1.9999 times the inverse curvature.
    let weight = (1.9999 * f64::powi(2.0, 13) / 1e4).sqrt();
    builder.add(Task::new(Point::new(rider, [0.0; 3])).weight(Quantity::Metres, weight));
    let solver = Solver::new(ProjectedGradient::default());
    let solver = solver.with_restarts(Restarts::none());
    let solution = solver.solve_once(&builder.build().unwrap(), &[1.0]);
    let solution = solution.unwrap();
    assert!(solution.reached && solution.iterations <= 3, "{solution:?}");
}
