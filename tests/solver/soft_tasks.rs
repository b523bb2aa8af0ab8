//! Promise: soft tasks act in the null space of the required tasks. A reachable required task is reached whatever the
//! weights, and soft tasks are at a minimum within it.

use kinopt::ik::Drag;
use kinopt::model::{JointId, Model};
use kinopt::problem::{Problem, TaskId};
use kinopt::solver::Termination;
use kinopt::spatial::Placement;
use kinopt::task::{
    FramePose, Inputs, LimitCentring, Point, Posture, Quantity, Residual, RowBlock, Smoothness,
    Task,
};
use kinopt::{Scalar, Solver};
use support::arms::panda;
use support::trees::configuration_of;
use support::{planar_arm, planar_tip};

use crate::soft_task_fixtures::{
    Add, drag, placement_of, problem, remaining_gradient, within_limits,
};
use support::random::{Random, case_count};

#[test]
fn panda_reaches_with_default_soft_tasks() {
    let (robot, base, tool) = panda();
    assert_eq!(base, "base");
    let (model, map) = (robot.model(), robot.map());
    let frame = model.frame(tool).unwrap();
    let kinds = ["posture", "limit centring", "smoothness"];
    let (mut left, mut steps) = (Vec::new(), [0; 3]);
    let cases = case_count(60, 12);
    for (k, kind) in kinds.iter().enumerate() {
        for seed in 0..cases as u64 {
            let mut random = Random::new(seed);
            let [target_q, start, other] = [(); 3].map(|()| configuration_of(model, &mut random));
            let target = placement_of(model, tool, &target_q);
            let goal: Add<'_> = &|builder| {
                builder.add(FramePose::new(frame, target));
            };
            let pull: Add<'_> = &|builder| match k {
                0 => {
                    builder.add(Posture::new(model, &other));
                }
                1 => {
                    builder.add(LimitCentring::new(model));
                }
                _ => {
                    builder.add(Smoothness::new(model, &start, 0.01));
                }
            };
            let [goals, pulls] = [goal, pull].map(|add| problem(model, map, &[add]));
            let both = problem(model, map, &[goal, pull]);
            let alone = Solver::default().solve_once(&goals, &start).unwrap();
            let solution = Solver::default().solve_once(&both, &start).unwrap();
            assert!(
                alone.reached && solution.reached,
                "{kind} {seed}: {}",
                solution.explain()
            );
            assert_eq!(solution.termination, Termination::Reached);
            assert!(within_limits(&both, &solution.q));
            steps[k] += solution.iterations - alone.iterations;
            left.push(remaining_gradient(&goals, &pulls, &solution.q));
        }
    }
    left.sort_by(f64::total_cmp);
    let settled = left.iter().filter(|left| **left < 3e-3).count();
    assert!(settled * 100 >= 95 * left.len(), "{settled}: {left:?}");
    assert!(
        steps.iter().all(|s| *s < 30 * cases),
        "{steps:?} of {cases}"
    );
}

#[test]
fn rig_reaches_with_all_kinds_of_soft_tasks() {
    let (mut left, mut steps) = (Vec::new(), 0);
    for seed in 0..6 {
        let drag = drag(seed);
        let model = drag.rig.skeleton.model();
        let goal: Add<'_> = &|builder| drag.add_goals(builder, 1.0);
        let pull: Add<'_> = &|builder| drag.add_pulls(builder);
        let [goals, pulls] = [goal, pull].map(|add| problem(model, &drag.map, &[add]));
        let both = problem(model, &drag.map, &[pull, goal]);
        let alone = Solver::default().solve_once(&goals, &drag.start).unwrap();
        let solution = Solver::default().solve_once(&both, &drag.start).unwrap();
        assert_eq!(alone.reached, solution.reached);
        assert!(solution.reached, "{seed}: {}", solution.explain());
        assert!(within_limits(&both, &solution.q));
        let again = Solver::default().solve_once(&both, &drag.start).unwrap();
        assert_eq!(again.q, solution.q);
        left.push(remaining_gradient(&goals, &pulls, &solution.q));
        steps += solution.iterations - alone.iterations;
    }
    assert!(left.iter().all(|left| *left < 1e-3), "{left:?}");
    assert!(steps < 6 * 50, "{steps}");
}

/// Rows with an infinite tolerance constrain nothing: a pose with free orientation leaves the same freedom as a point.
#[test]
fn rows_of_infinite_tolerance_constrain_nothing() {
    let (robot, _, tool) = panda();
    let (model, map) = (robot.model(), robot.map());
    let frame = model.frame(tool).unwrap();
    let mut left = Vec::new();
    for seed in 0..4 {
        let mut random = Random::new(seed);
        let [target_q, start, other] = [(); 3].map(|()| configuration_of(model, &mut random));
        let target = placement_of(model, tool, &target_q);
        let pose: Add<'_> = &|builder| {
            let pose = Task::new(FramePose::new(frame, target));
            builder.add(pose.tolerance(Quantity::Radians, f64::INFINITY));
        };
        let point: Add<'_> = &|builder| {
            builder.add(Point::new(frame, target.translation));
        };
        let pull: Add<'_> = &|builder| {
            builder.add(Posture::new(model, &other));
        };
        let [goals, pulls] = [point, pull].map(|add| problem(model, map, &[add]));
        // Either order of the tasks.
        for tasks in [[pose, pull], [pull, pose]] {
            let both = problem(model, map, &tasks);
            let solution = Solver::default().solve_once(&both, &start).unwrap();
            assert!(solution.reached, "{seed}: {}", solution.explain());
            left.push(remaining_gradient(&goals, &pulls, &solution.q));
        }
    }
    assert!(left.iter().all(|left| *left < 3e-3), "{left:?}");
}

/// Soft tasks continue from frame to frame, with at most two steps each.
#[test]
fn posture_costs_a_drag_few_steps_per_frame() {
    let figure = drag(3);
    let (skeleton, rest) = (&figure.rig.skeleton, &figure.rest);
    let model = skeleton.model();
    let at = figure.rig.transforms(rest);
    let places = figure
        .rig
        .tips
        .iter()
        .map(|&tip| figure.rig.tip(&at, tip) * 0.9);
    let places: Vec<_> = places.collect();
    let begin = |posture: bool| -> (Drag, TaskId<Point>) {
        let mut builder = Problem::builder(model);
        let tips = figure.rig.tips.iter().zip(&places);
        let tasks: Vec<_> = tips
            .map(|(&tip, position)| builder.add(Point::new(skeleton.tip(tip), *position)))
            .collect();
        if posture {
            builder.add(Posture::new(model, rest));
        }
        (Drag::new(builder.build().unwrap(), rest).unwrap(), tasks[0])
    };
    let frames = 60;
    let mut steps = [0; 2];
    for (with, steps) in steps.iter_mut().enumerate() {
        let (mut drag, hand) = begin(with == 1);
        assert!(drag.settle(200).reached);
        for frame in 0..frames {
            let turn = 0.05 * f64::from(frame);
            let sway = nalgebra::Vector3::new(turn.sin(), 1.0 - turn.cos(), 0.0) * 0.05;
            drag.target_mut(hand).unwrap().set_target(places[0] + sway);
            let solution = drag.advance();
            assert!(solution.reached, "{}", solution.explain());
            *steps += solution.iterations;
        }
        if with == 0 {
            continue;
        }
        // `settle` continues to the minimum of the posture.
        drag.settle(200);
        assert!(drag.is_at_rest());
        let goal: Add<'_> = &|builder| {
            for (k, (&tip, position)) in figure.rig.tips.iter().zip(&places).enumerate() {
                let turn = 0.05 * f64::from(frames - 1);
                let sway = nalgebra::Vector3::new(turn.sin(), 1.0 - turn.cos(), 0.0) * 0.05;
                let sway = if k == 0 { sway } else { sway * 0.0 };
                builder.add(Point::new(skeleton.tip(tip), position + sway));
            }
        };
        let pull: Add<'_> = &|builder| {
            builder.add(Posture::new(model, rest));
        };
        let [goals, pulls] = [goal, pull].map(|add| problem(model, &figure.map, &[add]));
        let left = remaining_gradient(&goals, &pulls, drag.q());
        assert!(left < 1e-2, "{left}");
    }
    // Two steps of the soft task, and the required tasks' steps from its minimum.
    assert!(steps[1] <= steps[0] + 5 * frames as usize, "{steps:?}");
}

/// Two joints whose sum is 0.5.
#[derive(Clone)]
struct Sum([JointId; 2]);

impl Residual for Sum {
    fn inputs(&self) -> Inputs {
        Inputs::joints(self.0)
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Ratio, 1)]
    }

    fn evaluate<S: Scalar>(&self, _: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        residual[0] = joints[0] + joints[1] - S::constant(0.5);
    }
}

/// Soft tasks may have rows on one, two or many joints.
#[test]
fn soft_task_on_two_joints_moves_both() {
    let mut builder = Model::builder("three joints at one place");
    let z = kinopt::spatial::Vector3::new(0.0, 0.0, 1.0);
    let (identity, link) = (
        Placement::identity(),
        Placement::translation([1.0, 0.0, 0.0].into()),
    );
    let [a, b, c] = ["a", "b", "c"].map(|name| builder.continuous(name, None, identity, z));
    let tip = builder.frame("tip", Some(c), link);
    let model = builder.build().unwrap();
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(tip, [0.6, 0.8, 0.0]));
    builder.add(Task::new(Sum([a, b])).preference());
    let problem = builder.build().unwrap();
    let solution = Solver::default()
        .solve_once(&problem, &[0.0, 0.1, 0.5])
        .unwrap();
    assert!(solution.reached);
    assert!(
        (solution.q[0] + solution.q[1] - 0.5).abs() < 1e-4,
        "{:?}",
        solution.q
    );
}

/// Soft tasks that are linear in the joints reach their minimum in one step, for any sparsity of the rows.
#[test]
fn linear_soft_tasks_converge_in_one_step() {
    let mut builder = Model::builder("three joints at one place");
    let z = kinopt::spatial::Vector3::new(0.0, 0.0, 1.0);
    let origin = Placement::identity();
    let [a, b, c] = ["a", "b", "c"].map(|name| builder.continuous(name, None, origin, z));
    let link = Placement::translation([1.0, 0.0, 0.0].into());
    let tip = builder.frame("tip", Some(c), link);
    let model = builder.build().unwrap();
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(tip, [1.0, 0.0, 0.0]));
    builder.add(Task::new(Sum([a, b])).preference());
    builder.add(Task::new(Posture::of_joints([(a, 0.4)])).scale(2.0));
    let once = kinopt::solver::Stopping::default().with_max_iterations(1);
    let solver = Solver::default().with_stopping(once);
    let solution = solver.solve_once(&builder.build().unwrap(), &[0.0; 3]);
    let q = solution.unwrap().q;
    assert!(
        (q[0] - 0.4).abs() < 1e-4 && (q[1] - 0.1).abs() < 1e-4,
        "{q:?}"
    );
}

/// A task is reached if all its rows are.
#[test]
fn partly_reached_task_is_not_reached() {
    let model = planar_arm(&[1.0, 0.4], Some((-1.0, 1.0)));
    let tip = model.frame("tip").unwrap();
    // No joint rotates about x.
    let turned = nalgebra::Rotation3::from_euler_angles(0.7, 0.0, 0.0).into_inner();
    let target = Placement::new(turned.into(), [1.2, 0.3, 0.0].into());
    for (free, reached) in [
        (Quantity::Metres, [true, false]),
        (Quantity::Radians, [false, true]),
    ] {
        let placement = Placement::new(turned.into(), [1.2, 0.3, 0.5].into());
        let pose = FramePose::new(
            tip,
            if free == Quantity::Metres {
                target
            } else {
                placement
            },
        );
        let mut builder = Problem::builder(&model);
        builder.add(Task::new(pose).tolerance(free, f64::INFINITY));
        let problem = builder.build().unwrap();
        let solution = Solver::default().solve_once(&problem, &[0.3, 0.2]).unwrap();
        let task = solution.tasks().next().unwrap();
        let rows: Vec<bool> = task.rows.iter().map(|rows| rows.reached).collect();
        assert_eq!(rows, reached);
        assert!(!task.reached && !solution.reached);
    }
}

/// Weights of reached required tasks do not change the soft tasks.
#[test]
fn soft_tasks_ignore_weights_of_required_tasks() {
    let model = planar_arm(&[0.6, 0.5, 0.4, 0.3], Some((-2.5, 2.5)));
    let tip = model.frame("tip").unwrap();
    let pulled = |weight: f64| {
        let mut builder = Problem::builder(&model);
        builder.add(Task::new(Point::new(tip, [0.9, 0.7, 0.0])).weight(Quantity::Metres, weight));
        builder.add(Task::new(Posture::new(&model, &[-0.4, 0.9, -0.2, 0.8])).preference());
        let problem = builder.build().unwrap();
        let solution = Solver::default().solve_once(&problem, &[0.3, 0.2, 0.3, 0.1]);
        let solution = solution.unwrap();
        assert!(solution.reached, "{weight:e}: {}", solution.explain());
        crate::soft_task_fixtures::pull_of(&solution)
    };
    let usual = pulled(1.0);
    for weight in [1e-10, 1e-5, 1e5, 1e13] {
        let pull = pulled(weight);
        assert!(
            (pull - usual).abs() < 1e-4 * usual,
            "{weight:e}: {pull} {usual}"
        );
    }
}

/// A reached required task moves by at most a thousandth of its tolerance, whatever its weight and the soft tasks'
/// steps.
#[test]
fn reached_tasks_stay_reached_at_any_weight() {
    let lengths = [0.6, 0.5, 0.4, 0.3];
    let model = planar_arm(&lengths, Some((-2.5, 2.5)));
    let tip = model.frame("tip").unwrap();
    let start = [0.9, -0.2, 0.4, -0.3];
    let at = planar_tip(&lengths, &start);
    for weight in [1e-6, 1.0, 1e6] {
        let mut builder = Problem::builder(&model);
        let goal = Task::new(Point::new(tip, at)).weight(Quantity::Metres, weight);
        builder.add(goal.tolerance(Quantity::Metres, 0.1));
        builder.add(Posture::new(&model, &[-0.8, 1.9, -0.2, 0.8]));
        let problem = builder.build().unwrap();
        let once = kinopt::solver::Stopping::default().with_max_iterations(1);
        let solver = Solver::default().with_stopping(once);
        let solution = solver.solve_once(&problem, &start).unwrap();
        assert!(solution.reached && solution.q != start);
        let apart = (planar_tip(&lengths, &solution.q) - at).norm();
        assert!(apart <= 1.001e-4, "{weight:e}: {apart:e}");
    }
}
