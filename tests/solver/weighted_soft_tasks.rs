//! Promise: soft tasks that are weighted against required tasks displace them, and the solution names them. An
//! interrupted or non-finite soft task is reported.

use std::ops::ControlFlow;
use std::time::Duration;

use kinopt::problem::{Preferences, Problem};
use kinopt::solver::{Iteration, Stopping, Termination};
use kinopt::task::{FramePose, Point, Posture, Quantity, Task};
use kinopt::{Solver, Workspace};
use support::arms::panda;
use support::planar_arm;
use support::random::Random;
use support::trees::configuration_of;

use crate::soft_task_fixtures::{linearised, placement_of};

#[test]
fn weighted_soft_tasks_are_named() {
    let (robot, _, tool) = panda();
    let (model, map) = (robot.model(), robot.map());
    let frame = model.frame(tool).unwrap();
    let mut random = Random::new(2);
    let [target_q, other] = [(); 2].map(|()| configuration_of(model, &mut random));
    let target = placement_of(model, tool, &target_q);
    for weight in [1.0, 1e-2] {
        let mut builder = Problem::builder(model);
        builder.parameters(map.clone());
        builder.add(FramePose::new(frame, target));
        builder.add(
            Task::new(Posture::new(model, &other))
                .weight(Quantity::JointUnits, weight)
                .named("my posture"),
        );
        builder.add(Task::new(Posture::new(model, &target_q)).weight(Quantity::JointUnits, 1e-9));
        builder.preferences(Preferences::Traded);
        let problem = builder.build().unwrap();
        assert_eq!(problem.preferences(), Preferences::Traded);
        let solution = Solver::default().solve_once(&problem, &target_q).unwrap();
        assert!(!solution.reached);
        let named: Vec<&str> = solution.pulling_preferences().collect();
        assert_eq!(named, ["my posture"]);
        let words = solution.explain();
        assert!(
            words.contains("my posture pulls against the required tasks"),
            "{words}"
        );
        assert!(words.contains("sum of required and soft tasks"), "{words}");
    }
}

/// The strongest first, in any order of addition.
#[test]
fn strongest_soft_task_is_named_first() {
    let model = planar_arm(&[1.0, 0.8], Some((-2.5, 2.5)));
    let tip = model.frame("tip").unwrap();
    for weights in [[0.3, 0.5, 0.2], [0.5, 0.2, 0.3]] {
        let mut builder = Problem::builder(&model);
        builder.add(Point::new(tip, [0.9, 0.9, 0.0]));
        for weight in weights {
            let posture = Task::new(Posture::new(&model, &[-1.0, 0.5]));
            let posture = posture.weight(Quantity::JointUnits, weight);
            builder.add(posture.named(format!("{weight}")));
        }
        builder.preferences(Preferences::Traded);
        let problem = builder.build().unwrap();
        let solution = Solver::default().solve_once(&problem, &[0.2, 0.9]).unwrap();
        let named: Vec<&str> = solution.pulling_preferences().collect();
        assert_eq!(named, ["0.5", "0.3", "0.2"]);
    }
}

/// A joint that required tasks push onto its limit is explained by the limit, not by a soft task that pulls it back.
#[test]
fn soft_task_pulling_off_a_limit_is_not_named() {
    let model = planar_arm(&[1.0, 0.8], Some((-0.5, 0.5)));
    let tip = model.frame("tip").unwrap();
    let joints = model.moving_joints();
    for side in [-1.0, 1.0] {
        let mut builder = Problem::builder(&model);
        // Beyond the first joint's limit; the second joint approaches it.
        builder.add(Point::new(tip, [0.2, 1.6 * side, 0.0]));
        let back = Posture::of_joints([(joints[0], 0.0)]);
        builder.add(Task::new(back).scale(0.9).named("back"));
        let straight = Posture::of_joints([(joints[1], 0.0)]);
        builder.add(Task::new(straight).scale(2.0).named("straight"));
        builder.preferences(Preferences::Traded);
        let problem = builder.build().unwrap();
        let solution = Solver::default().solve_once(&problem, &[0.0, 0.1]).unwrap();
        assert_eq!(solution.q[0], 0.5 * side);
        assert!(solution.q[1].abs() < 0.49, "{:?}", solution.q);
        let named: Vec<&str> = solution.pulling_preferences().collect();
        assert_eq!(named, ["straight"]);
    }
}

#[test]
fn without_required_tasks_the_sum_is_minimised() {
    let model = planar_arm(&[0.5, 0.4, 0.3], Some((-2.0, 2.0)));
    let tip = model.frame("tip").unwrap();
    let solve = |goal: bool| {
        let mut builder = Problem::builder(&model);
        let point = Task::new(Point::new(tip, [0.5, 0.5, 0.0]));
        builder.add(match goal {
            true => point.tolerance(Quantity::Metres, f64::INFINITY),
            false => point.preference(),
        });
        builder.add(Posture::new(&model, &[0.3, 0.3, 0.3]));
        let problem = builder.build().unwrap();
        let solution = Solver::default().solve_once(&problem, &[0.1; 3]).unwrap();
        let (residual, jacobian) = linearised(&problem, &solution.q);
        assert!((jacobian.transpose() * residual).amax() < 1e-7);
        assert!(solution.reached);
        solution.q
    };
    assert_eq!(solve(true), solve(false));
}

#[test]
fn interrupted_or_nan_soft_task_is_reported() {
    let (robot, _, tool) = panda();
    let (model, map) = (robot.model(), robot.map());
    let frame = model.frame(tool).unwrap();
    let mut random = Random::new(4);
    let [target_q, other] = [(); 2].map(|()| configuration_of(model, &mut random));
    let mut builder = Problem::builder(model);
    builder.parameters(map.clone());
    builder.add(FramePose::new(frame, placement_of(model, tool, &target_q)));
    let task = builder.add(Posture::new(model, &other));
    let problem = builder.build().unwrap();
    for (cancels, ended) in [
        (true, Termination::Cancelled),
        (false, Termination::TimeLimit),
    ] {
        let limit = Duration::from_millis(200);
        let solver = Solver::default().with_stopping(Stopping::default().with_time_limit(limit));
        let mut seen = 0;
        let mut watch = |_: &Iteration<'_>| {
            seen += 1;
            match (seen, cancels) {
                (3, true) => return ControlFlow::Break(()),
                (3, false) => std::thread::sleep(limit),
                _ => {}
            }
            ControlFlow::Continue(())
        };
        let mut workspace = Workspace::new();
        // Required tasks are reached at the start.
        let solution = solver.solve_observed(&problem, &target_q, &mut workspace, &mut watch);
        let solution = solution.unwrap();
        assert!(solution.reached);
        assert_eq!(solution.termination, ended);
        assert!(
            solution
                .explain()
                .contains("descent of the soft tasks early")
        );
    }
    let mut targets = problem.targets();
    let posture = targets.get_mut(task).unwrap();
    posture.set_reference(&vec![f64::NAN; other.len()]).unwrap();
    let question = problem.with_targets(&targets).unwrap();
    let solution = Solver::default().solve_once(question, &target_q).unwrap();
    assert_eq!(solution.termination, Termination::NonFinite);
    assert!(solution.q.iter().all(|v| v.is_finite()));
}
