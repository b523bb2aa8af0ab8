//! Promise: soft tasks do not increase the miss of an unreachable required task. They use the freedom that the miss
//! leaves.

use kinopt::model::{Limits, Model};
use kinopt::problem::Problem;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{Point, Posture, Quantity, Task};
use kinopt::{Scalar, Solution, Solver};
use support::arms::panda;
use support::planar_arm;
use support::random::{Random, case_count};
use support::tasks::{Curve, OfJoint};
use support::trees::configuration_of;

use crate::soft_task_fixtures::{Add, drag, problem, pull_of, within_limits};

#[test]
fn soft_tasks_do_not_increase_a_miss() {
    for seed in 0..case_count(4, 1) as u64 {
        let drag = drag(seed);
        let model = drag.rig.skeleton.model();
        let goal: Add<'_> = &|builder| drag.add_goals(builder, 4.0);
        let pull: Add<'_> = &|builder| {
            builder.add(Posture::new(model, &drag.rest));
        };
        let goals = problem(model, &drag.map, &[goal]);
        let both = problem(model, &drag.map, &[goal, pull]);
        let alone = Solver::default().solve_once(&goals, &drag.start).unwrap();
        let solution = Solver::default().solve_once(&both, &drag.start).unwrap();
        assert!(!alone.reached && !solution.reached);
        let missed = solution.cost - pull_of(&solution);
        assert!(
            missed <= alone.cost * (1.0 + 2e-9),
            "{seed}: {missed} {}",
            alone.cost
        );
        let pull = |q: &[f64]| {
            let deviations = q.iter().zip(&drag.rest).map(|(a, b)| (a - b).powi(2));
            0.5 * deviations.sum::<f64>()
        };
        assert!(
            pull(&solution.q) < pull(&alone.q),
            "{seed}: no nearer to rest"
        );
        assert!(within_limits(&both, &solution.q));
        assert_eq!(solution.pulling_preferences().count(), 0);
    }
}

#[test]
fn soft_tasks_use_freedom_at_a_miss() {
    // A stretched arm can still rotate about its line, and a joint without influence can move.
    let (robot, _, tool) = panda();
    let (model, map) = (robot.model(), robot.map());
    let frame = model.frame(tool).unwrap();
    let mut random = Random::new(5);
    let start = configuration_of(model, &mut random);
    let other = configuration_of(model, &mut random);
    let goal: Add<'_> = &|builder| {
        builder.add(Point::new(frame, [2.0, 1.0, 0.4]));
    };
    let pull: Add<'_> = &|builder| {
        builder.add(Posture::new(model, &other));
    };
    let goals = problem(model, map, &[goal]);
    let both = problem(model, map, &[goal, pull]);
    let alone = Solver::default().solve_once(&goals, &start).unwrap();
    let solution = Solver::default().solve_once(&both, &start).unwrap();
    let missed = |s: &Solution| s.tasks().next().unwrap().position_error().unwrap();
    assert!((missed(&alone) - missed(&solution)).abs() < 1e-8);
    // The last joint rotates about the tool's line, so nothing constrains it.
    let last = 6;
    assert!(
        (solution.q[last] - other[last]).abs() < 1e-4,
        "{solution:?}"
    );
    assert!(solution.is_out_of_reach());
    assert!(
        solution.explain().contains("Out of reach: point of"),
        "{}",
        solution.explain()
    );
}

/// Goal with residual 1 below 0.3 rad and 1.2 above 0.5 rad, flat on both sides.
#[derive(Clone)]
struct Terrace;

impl Curve for Terrace {
    fn at<S: Scalar>(&self, q: S) -> S {
        let c = S::constant;
        let fraction = ((q - c(0.3)) * c(5.0)).max(c(0.0)).min(c(1.0));
        c(1.0) + c(0.2) * fraction * fraction * (c(3.0) - c(2.0) * fraction)
    }
}

/// A step over the edge ends without a gradient back, so it must not be taken.
#[test]
fn soft_task_step_over_an_edge_is_rejected() {
    let model = planar_arm(&[1.0], Some((-2.0, 2.0)));
    let joint = model.joint("joint 0").unwrap();
    let mut builder = Problem::builder(&model);
    builder.add(Task::new(OfJoint(joint, Terrace)).tolerance(Quantity::Ratio, 1e-6));
    builder.add(Posture::new(&model, &[1.5]));
    let problem = builder.build().unwrap();
    let solution = Solver::default().solve_once(&problem, &[0.0]).unwrap();
    assert!(!solution.reached);
    let missed = solution
        .tasks()
        .next()
        .unwrap()
        .error(Quantity::Ratio)
        .unwrap();
    assert!(missed < 1.0 + 1e-6, "{missed} at {:?}", solution.q);
    assert!(solution.q[0] > 0.1, "{:?}", solution.q);
}

/// A joint on a limit that the required task does not push against follows the soft task.
#[test]
fn limit_without_required_push_is_released() {
    let mut builder = Model::builder("aside");
    let (z, limits) = (Vector3::new(0.0, 0.0, 1.0), Limits::new(-1.0, 1.0));
    let joint = |builder: &mut kinopt::model::ModelBuilder, name: &str| {
        builder.revolute(name, None, Placement::identity(), z, limits)
    };
    let arm = joint(&mut builder, "arm");
    joint(&mut builder, "aside");
    let link = Placement::translation([1.0, 0.0, 0.0].into());
    let tip = builder.frame("tip", Some(arm), link);
    let model = builder.build().unwrap();
    for side in [-1.0, 1.0] {
        let mut builder = Problem::builder(&model);
        builder.add(Point::new(tip, [1.5, 0.5, 0.0]));
        builder.add(Posture::new(&model, &[0.0, -0.4 * side]));
        let problem = builder.build().unwrap();
        let solution = Solver::default()
            .solve_once(&problem, &[0.1, side])
            .unwrap();
        assert!(!solution.reached);
        assert!(
            (solution.q[1] + 0.4 * side).abs() < 1e-4,
            "{:?}",
            solution.q
        );
    }
}
