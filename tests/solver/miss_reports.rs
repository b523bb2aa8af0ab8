//! Promise: errors of zero weight are reported, and a miss reports the number of agreeing attempts.

use kinopt::ik::{Drag, Restarts};
use kinopt::model::{JointId, Limits, Model};
use kinopt::problem::Problem;
use kinopt::solver::Termination;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{FramePose, Inputs, Point, Quantity, Residual, RowBlock, Task};
use kinopt::{Scalar, Solution, Solver, Workspace};
use support::arms::robot;
use support::planar_arm;
use support::random::Random;
use support::trees::configuration_of;

use crate::soft_task_fixtures::placement_of;

#[test]
fn zero_weight_task_reports_its_error() {
    let robot = robot("universal_ur5e");
    let model = robot.model();
    let tool = model.frame("flange").unwrap();
    let mut random = Random::new(1);
    let [target_q, start] = [(); 2].map(|()| configuration_of(model, &mut random));
    let target = placement_of(model, "flange", &target_q);
    for (weight, of_place) in [(0.0, 1.0), (1e-300, 2.0), (1e-160, 0.5)] {
        let mut builder = Problem::builder(model);
        builder.parameters(robot.map().clone());
        let pose = Task::new(FramePose::new(tool, target)).weight(Quantity::Radians, weight);
        builder.add(pose.weight(Quantity::Metres, of_place));
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
        // No weight, so no requirement.
        assert!(solution.reached && task.reached);
        assert!(task.position_error().unwrap() <= 1e-6);
    }
}

#[test]
fn agreeing_attempts_are_counted_and_reported() {
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
    // In the hole of the long link: nothing proves it unreachable, but attempts agree.
    let hole = solve([0.2, 0.1, 0.0], 32);
    assert!(!hole.reached && hole.agreeing >= 3 && !hole.is_out_of_reach());
    let message = format!(
        "{} of {} attempts ended with this error",
        hole.agreeing, hole.attempts
    );
    assert!(hole.explain().contains(&message), "{}", hole.explain());
    let mut others = hole.clone();
    (others.agreeing, others.attempts) = (3, 7);
    assert!(others.explain().contains("3 of 7 attempts"));
    let alone = solve([0.2, 0.1, 0.0], 1);
    assert_eq!(alone.agreeing, 1);
    assert!(
        alone.explain().contains("Only one attempt"),
        "{}",
        alone.explain()
    );
    let unreachable = solve([3.0, 0.0, 0.0], 32);
    assert!(unreachable.is_out_of_reach());
    let words = unreachable.explain();
    assert!(
        words.contains("3.000 m from `joint 0`") && words.contains("reaches 1.400 m"),
        "{words}"
    );
    assert_eq!(solve([1.0, 0.5, 0.0], 32).agreeing, 0);
}

/// A reused workspace counts attempts of the present problem only.
#[test]
fn attempts_of_earlier_problems_do_not_agree() {
    let model = planar_arm(&[1.0, 0.4], Some((-2.5, 2.5)));
    let tip = model.frame("tip").unwrap();
    let solver = Solver::default();
    let mut workspace = Workspace::new();
    // The last is farther away than all before.
    for target in [
        [0.2, 0.1, 0.0],
        [0.2, 0.1, 0.0],
        [0.2, 0.05, 0.0],
        [0.05, 0.1, 0.0],
    ] {
        let mut builder = Problem::builder(&model);
        builder.add(Point::new(tip, target));
        let problem = builder.build().unwrap();
        let alone = solver.solve_once(&problem, &[0.3, 0.2]).unwrap();
        let again = solver.solve(&problem, &[0.3, 0.2], &mut workspace).unwrap();
        assert!(!alone.reached && alone.agreeing >= 3, "{target:?}");
        assert!(again.agreeing <= again.attempts, "{target:?}: {again:?}");
        let reported = |solution: &Solution| (solution.agreeing, solution.attempts, solution.cost);
        assert_eq!(reported(again), reported(&alone), "{target:?}");
    }
}

/// Rows of one unit in several blocks are one error.
#[derive(Clone)]
struct Split(JointId);

impl Residual for Split {
    fn inputs(&self) -> Inputs {
        Inputs::joints([self.0])
    }

    fn rows(&self) -> Vec<RowBlock> {
        let metres = || RowBlock::new(Quantity::Metres, 1);
        vec![metres(), RowBlock::new(Quantity::Radians, 1), metres()]
    }

    fn evaluate<S: Scalar>(&self, _: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        residual[0] = S::constant(3.0);
        residual[1] = joints[0];
        residual[2] = S::constant(-4.0);
    }
}

#[test]
fn error_combines_row_blocks_of_one_unit() {
    let model = planar_arm(&[1.0], Some((-2.0, 2.0)));
    let mut builder = Problem::builder(&model);
    builder.add(Split(model.joint("joint 0").unwrap()));
    let problem = builder.build().unwrap();
    let solution = Solver::default().solve_once(&problem, &[0.4]).unwrap();
    let task = solution.tasks().next().unwrap();
    let errors = [Quantity::Metres, Quantity::Ratio].map(|quantity| task.error(quantity));
    assert!((errors[0].unwrap() - 5.0).abs() < 1e-12 && errors[1].is_none());
}

/// A target beyond the chain's length by less than its tolerance is not out of reach, whatever else blocks it.
#[test]
fn out_of_reach_includes_the_tolerance() {
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

/// A reached target is not out of reach, whatever the workspace or drag solved before.
#[test]
fn reached_target_is_not_out_of_reach() {
    let model = planar_arm(&[1.0, 0.4], Some((-2.5, 2.5)));
    let tip = model.frame("tip").unwrap();
    let mut builder = Problem::builder(&model);
    let hand = builder.add(Point::new(tip, [3.0, 0.0, 0.0]));
    let problem = builder.build().unwrap();
    let solver = Solver::default();
    let mut workspace = Workspace::new();
    let solution = solver.solve(&problem, &[0.3, 0.2], &mut workspace).unwrap();
    assert!(solution.is_out_of_reach());
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(tip, [1.0, 0.5, 0.0]));
    let near = builder.build().unwrap();
    let near = solver.solve(&near, &[0.3, 0.2], &mut workspace).unwrap();
    assert!(near.reached && !near.is_out_of_reach());
    let mut drag = Drag::new(problem, &[0.3, 0.2]).unwrap();
    assert!(drag.settle(100).is_out_of_reach());
    drag.target_mut(hand).unwrap().set_target([1.0, 0.5, 0.0]);
    let near = drag.settle(100);
    assert!(near.reached && !near.is_out_of_reach());
}

/// A part within its tolerance is no miss.
#[test]
fn only_the_missed_part_of_a_pose_is_reported() {
    let model = planar_arm(&[1.0, 0.5], Some((-1.0, 1.0)));
    let tip = model.frame("tip").unwrap();
    let turned = nalgebra::Rotation3::from_euler_angles(0.5, 0.0, 0.0).into_inner();
    let target = Placement::new(turned.into(), [0.4, 0.3, 2.0].into());
    for (within, reported) in [
        (Quantity::Radians, [true, false]),
        (Quantity::Metres, [false, true]),
    ] {
        let mut builder = Problem::builder(&model);
        builder.add(Task::new(FramePose::new(tip, target)).tolerance(within, 9.0));
        let problem = builder.build().unwrap();
        let words = Solver::default().solve_once(&problem, &[0.1, 0.2]);
        let words = words.unwrap().explain();
        let misses = words.lines().find(|line| line.contains("misses by"));
        let misses = misses.unwrap().trim_end_matches('.');
        let has = |unit: &str| misses.split(' ').any(|word| word == unit);
        assert_eq!([has("m"), has("rad")], reported, "{misses}");
    }
}

/// A point with an offset from its frame extends the reach by the offset.
#[test]
fn point_offset_extends_the_reach() {
    let model = planar_arm(&[1.0], Some((-0.5, 0.5)));
    let tip = model.frame("tip").unwrap();
    for (distance, beyond) in [(1.4, false), (1.6, true)] {
        let mut builder = Problem::builder(&model);
        let (sin, cos) = 1.0_f64.sin_cos();
        let target = [distance * cos, distance * sin, 0.0];
        builder.add(Point::new(tip, target).at([0.5, 0.0, 0.0]));
        let solution = Solver::default().solve_once(&builder.build().unwrap(), &[0.1]);
        let solution = solution.unwrap();
        assert!(!solution.reached);
        assert_eq!(solution.is_out_of_reach(), beyond, "{}", solution.explain());
    }
}

/// A prismatic joint extends the reach by its farther limit, at any position in the chain.
#[test]
fn prismatic_joint_reaches_its_farther_limit() {
    let (x, z) = (Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.0, 0.0, 1.0));
    let (turns, none) = (Limits::new(-0.1, 0.1), Placement::identity());
    let forwards = Limits::new(-0.2, 1.0);
    let backwards = Limits::new(-1.0, 0.2);
    for (slides, slide_first) in [
        (forwards, true),
        (forwards, false),
        (backwards, true),
        (backwards, false),
    ] {
        let mut builder = Model::builder("slide");
        let last = if slide_first {
            let slide = builder.prismatic("slide", None, none, x, slides);
            builder.revolute("turn", Some(slide), none, z, turns)
        } else {
            let turn = builder.revolute("turn", None, none, z, turns);
            builder.prismatic("slide", Some(turn), none, x, slides)
        };
        let link = Placement::translation(x * 0.3);
        let tip = builder.frame("tip", Some(last), link);
        let model = builder.build().unwrap();
        for (distance, beyond) in [(1.25, false), (1.35, true)] {
            let mut builder = Problem::builder(&model);
            builder.add(Point::new(tip, [distance * 0.8, distance * 0.6, 0.0]));
            let solution = Solver::default().solve_once(&builder.build().unwrap(), &[0.0; 2]);
            let solution = solution.unwrap();
            assert!(!solution.reached);
            assert_eq!(solution.is_out_of_reach(), beyond, "{}", solution.explain());
        }
    }
}

/// A miss agrees at least with itself, for any attempt that it continued.
#[test]
fn reported_miss_agrees_with_itself() {
    let mut reported = 0;
    for seed in 0..6 {
        let rig = support::bones::RandomRig::new(seed);
        let mut random = Random::new(seed);
        let problem = rig.drawn_to(|| random.vector(1.5));
        let start = configuration_of(rig.skeleton.model(), &mut random);
        let solution = Solver::default().solve_once(&problem, &start).unwrap();
        if solution.termination == Termination::Stationary {
            assert!(solution.agreeing >= 1, "{seed}: {}", solution.explain());
            reported += 1;
        }
    }
    assert!(reported >= 3, "{reported}");
}

#[test]
fn unreachable_soft_task_is_not_blamed() {
    let model = planar_arm(&[1.0, 0.4], Some((-0.1, 0.1)));
    let tip = model.frame("tip").unwrap();
    let explained = |far_is_goal: bool| {
        let mut builder = Problem::builder(&model);
        // Within the chain's length, but not within its limits.
        builder.add(Point::new(tip, [0.0, 1.0, 0.0]));
        let far_task = Task::new(Point::new(tip, [9.0, 0.0, 0.0])).named("far");
        builder.add(if far_is_goal {
            far_task
        } else {
            far_task.preference()
        });
        let problem = builder.build().unwrap();
        let solution = Solver::default().solve_once(&problem, &[0.0, 0.0]).unwrap();
        assert!(!solution.reached);
        solution.explain()
    };
    assert!(
        explained(true).contains("Out of reach: far"),
        "{}",
        explained(true)
    );
    assert!(
        !explained(false).contains("Out of reach"),
        "{}",
        explained(false)
    );
}

#[test]
fn overflowing_cost_has_no_gradient_norm() {
    let model = planar_arm(&[1.0, 0.4], None);
    let tip = model.frame("tip").unwrap();
    for (distance, finite) in [(1e100, true), (1e200, false)] {
        let mut builder = Problem::builder(&model);
        builder.add(Point::new(tip, [distance, 0.0, 0.0]));
        let problem = builder.build().unwrap();
        let solution = Solver::default().solve_once(&problem, &[0.3, 0.4]).unwrap();
        assert!(!solution.reached);
        assert_eq!(solution.cost.is_finite(), finite);
        let slope = solution.projected_gradient;
        assert_eq!(
            slope.is_some_and(f64::is_finite),
            finite,
            "{distance:e}: {slope:?}"
        );
        assert!(finite || slope.is_none(), "{slope:?}");
    }
}

/// `settle` counts as one attempt, whatever its frames searched: no more attempts agree than were made.
#[test]
fn agreeing_never_exceeds_attempts() {
    let model = planar_arm(&[1.0, 0.4], Some((-2.0, 2.5)));
    let tip = model.frame("tip").unwrap();
    let mut random = Random::new(9);
    let mut missed = 0;
    for case in 0..60 {
        let [x, y] = [(); 2].map(|()| random.within(-0.4, 0.4));
        let start = [(); 2].map(|()| random.within(-2.0, 2.5));
        let mut builder = Problem::builder(&model);
        builder.add(Point::new(tip, [x, y, 0.0]));
        let drag = Drag::new(builder.build().unwrap(), &start).unwrap();
        let mut drag = drag.with_search(Restarts::default()).unwrap();
        for frames in [1, 2, 40] {
            let solution = drag.settle(frames).clone();
            missed += usize::from(!solution.reached);
            assert!(
                solution.agreeing <= solution.attempts,
                "{case}: {} of {}",
                solution.agreeing,
                solution.attempts
            );
        }
    }
    assert!(missed > 40, "only {missed}");
}

/// Failed searches of a drag agree with its settled frame, and the report says so.
#[test]
fn failed_drag_search_agrees_with_the_frame() {
    let model = planar_arm(&[1.0, 0.4], Some((-2.5, 2.5)));
    let mut builder = Problem::builder(&model);
    // In the hole of the long link.
    builder.add(Point::new(model.frame("tip").unwrap(), [0.2, 0.1, 0.0]));
    let drag = Drag::new(builder.build().unwrap(), &[0.3, 0.2]).unwrap();
    let mut drag = drag.with_search(Restarts::default()).unwrap();
    let mut searched = 0;
    for _ in 0..60 {
        let solution = drag.advance().clone();
        if solution.reached || solution.attempts < 32 || drag.jump().is_some() {
            continue;
        }
        searched += 1;
        let message = format!(
            "{} of {} attempts ended with this error",
            solution.agreeing, solution.attempts
        );
        assert!(solution.agreeing > 2, "{}", solution.explain());
        assert!(
            solution.explain().contains(&message),
            "{}",
            solution.explain()
        );
    }
    assert!(searched > 0);
}
