//! Promise: an error that nobody weighs is told all the same, and a miss says how many attempts agree.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use kinopt::model::{FrameId, JointId};
use kinopt::problem::Problem;
use kinopt::spatial::Placement;
use kinopt::task::{Point, Pose, Quantity, Residual, Rows, Task};
use kinopt::{Scalar, Solver};
use support::arms::robot;
use support::planar_arm;
use support::random::Random;
use support::trees::configuration_of;

use crate::pulls::placement_of;

#[test]
fn a_task_of_weight_nothing_still_tells_its_error() {
    let robot = robot("universal_ur5e");
    let model = robot.model();
    let tool = model.frame("flange").unwrap();
    let mut random = Random::new(1);
    let [there, start] = [(); 2].map(|()| configuration_of(model, &mut random));
    let target = placement_of(model, "flange", &there);
    for weight in [0.0, 1e-300, 1e-160] {
        let mut builder = Problem::builder(model);
        builder.parameters(robot.map().clone());
        builder.add(Task::new(Pose::new(tool, target)).weight(Quantity::Radians, weight));
        let problem = builder.build().unwrap();
        let solution = Solver::default().solve_once(&problem, &start).unwrap();
        let now = placement_of(model, "flange", &solution.q);
        let between = |a: [f64; 3], b: [f64; 3]| -> f64 { (0..3).map(|k| a[k] * b[k]).sum() };
        let columns = |p: &Placement<f64>| [p.rotation.x, p.rotation.y, p.rotation.z];
        let traces = columns(&now).into_iter().zip(columns(&target));
        let trace: f64 = traces
            .map(|(a, b)| between(a.to_array(), b.to_array()))
            .sum();
        let angle = ((trace - 1.0) / 2.0).acos();
        let task = solution.tasks().next().unwrap();
        assert!(angle > 0.1, "{angle}");
        assert!(
            (task.orientation_error().unwrap() - angle).abs() < 1e-6,
            "{weight:e}: {task:?}"
        );
        // Nobody asked for it.
        assert!(solution.reached && task.reached);
        assert!(task.position_error().unwrap() <= 1e-6);
    }
}

#[test]
fn attempts_that_agree_are_counted_and_told() {
    let model = planar_arm(&[1.0, 0.4], Some((-2.5, 2.5)));
    let tip = model.frame("tip").unwrap();
    let solve = |target: [f64; 3], attempts: usize| {
        let mut builder = Problem::builder(&model);
        builder.add(Point::new(tip, target));
        let problem = builder.build().unwrap();
        let restarts = kinopt::ik::Restarts::default().with_attempts(attempts);
        let solver = Solver::default().with_restarts(restarts);
        solver.solve_once(&problem, &[0.3, 0.2]).unwrap()
    };
    // In the hole that the long link leaves: nothing proves it, but attempts agree.
    let hole = solve([0.2, 0.1, 0.0], 32);
    assert!(!hole.reached && hole.agreeing >= 3 && !hole.is_out_of_reach());
    let told = format!(
        "{} of {} attempts ended at this same miss",
        hole.agreeing, hole.attempts
    );
    assert!(hole.explain().contains(&told), "{}", hole.explain());
    let alone = solve([0.2, 0.1, 0.0], 1);
    assert_eq!(alone.agreeing, 1);
    assert!(
        alone.explain().contains("Only one attempt"),
        "{}",
        alone.explain()
    );
    let far = solve([3.0, 0.0, 0.0], 32);
    assert!(far.is_out_of_reach());
    let words = far.explain();
    assert!(
        words.contains("3.000 m from `joint 0`") && words.contains("reaches 1.400 m"),
        "{words}"
    );
    assert_eq!(solve([1.0, 0.5, 0.0], 32).agreeing, 0);
}

/// What a task measures in one unit in several places is one error.
struct Split(JointId);

impl Residual for Split {
    fn frames(&self) -> Vec<FrameId> {
        Vec::new()
    }

    fn joints(&self) -> Vec<JointId> {
        vec![self.0]
    }

    fn rows(&self) -> Vec<Rows> {
        let metres = || Rows::new(Quantity::Metres, 1);
        vec![metres(), Rows::new(Quantity::Radians, 1), metres()]
    }

    fn evaluate<S: Scalar>(&self, _: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        residual[0] = S::constant(3.0);
        residual[1] = joints[0];
        residual[2] = S::constant(-4.0);
    }
}

#[test]
fn the_error_of_rows_apart_is_that_of_all_of_them() {
    let model = planar_arm(&[1.0], Some((-2.0, 2.0)));
    let mut builder = Problem::builder(&model);
    builder.add(Split(model.joint("joint 0").unwrap()));
    let problem = builder.build().unwrap();
    let solution = Solver::default().solve_once(&problem, &[0.4]).unwrap();
    let task = solution.tasks().next().unwrap();
    let errors = [Quantity::Metres, Quantity::Ratio].map(|quantity| task.error(quantity));
    assert!((errors[0].unwrap() - 5.0).abs() < 1e-12 && errors[1].is_none());
}

/// Beyond the chain's length by less than its tolerance a goal is not out of reach, whatever else keeps
/// it from its place.
#[test]
fn out_of_reach_is_beyond_the_tolerance() {
    let model = planar_arm(&[1.0, 0.4], Some((-1.0, 1.0)));
    let tip = model.frame("tip").unwrap();
    for (x, beyond) in [(-1.45, false), (-1.55, true)] {
        let mut builder = Problem::builder(&model);
        builder.add(Task::new(Point::new(tip, [x, 0.0, 0.0])).tolerance(Quantity::Metres, 0.1));
        let problem = builder.build().unwrap();
        let solution = Solver::default().solve_once(&problem, &[0.3, 0.2]).unwrap();
        assert!(
            !solution.reached && solution.is_out_of_reach() == beyond,
            "{x}"
        );
    }
}

/// What is within its tolerance is no miss.
#[test]
fn of_a_pose_only_what_is_missed_is_told() {
    let model = planar_arm(&[1.0, 0.5], Some((-1.0, 1.0)));
    let tip = model.frame("tip").unwrap();
    let turned = nalgebra::Rotation3::from_euler_angles(0.5, 0.0, 0.0).into_inner();
    let target = Placement::new(turned.into(), [0.4, 0.3, 2.0].into());
    for (within, told) in [
        (Quantity::Radians, [true, false]),
        (Quantity::Metres, [false, true]),
    ] {
        let mut builder = Problem::builder(&model);
        builder.add(Task::new(Pose::new(tip, target)).tolerance(within, 9.0));
        let problem = builder.build().unwrap();
        let words = Solver::default().solve_once(&problem, &[0.1, 0.2]);
        let words = words.unwrap().explain();
        let misses = words.lines().find(|line| line.contains("misses by"));
        let misses = misses.unwrap().trim_end_matches('.');
        let has = |unit: &str| misses.split(' ').any(|word| word == unit);
        assert_eq!([has("m"), has("rad")], told, "{misses}");
    }
}
