//! Promise: cyclic coordinate descent rotates each joint by its signed angle and never increases the cost. It handles
//! tips, poses, prismatic and mimic joints.

use std::ops::ControlFlow;

use kinopt::geometric::{Ccd, Geometric};
use kinopt::ik::Restarts;
use kinopt::io::rig::Rig;
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{Limits, Model, ParameterMap};
use kinopt::solver::{Iteration, Stopping, Termination};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{FramePose, Point, Quantity, Task};
use kinopt::{Problem, Solution};
use support::random::Random;
use support::{planar_arm, planar_tip};

fn one_sweep() -> Ccd {
    let stopping = Stopping::default().with_max_iterations(1);
    let bare = Ccd::default().with_restarts(Restarts::none());
    bare.with_stopping(stopping)
}

fn reach_for(model: &Model, target: [f64; 3]) -> Problem {
    let mut builder = Problem::builder(model);
    builder.add(Point::new(model.frame("tip").unwrap(), target));
    builder.build().unwrap()
}

#[test]
fn rotation_follows_the_sign_of_the_angle() {
    for (limits, expected) in [(None, -0.7), (Some((-0.3, 2.0)), -0.3)] {
        let model = planar_arm(&[1.0], limits);
        let target = [f64::cos(-0.7), f64::sin(-0.7), 0.0];
        let solution = one_sweep()
            .solve(&reach_for(&model, target), &[0.0])
            .unwrap();
        assert!((solution.q[0] - expected).abs() < 1e-15);
        assert_eq!(solution.reached, limits.is_none());
    }
}

/// Two links on x, target (0, 2). The outer joint rotates by 90° + 26.57° (from (1, 0) to (−1, 2)). Then the inner one
/// rotates the resulting tip onto the y axis.
#[test]
fn sweep_runs_from_tip_to_root() {
    let model = planar_arm(&[1.0, 1.0], None);
    let solution = one_sweep()
        .solve(&reach_for(&model, [0.0, 2.0, 0.0]), &[0.0; 2])
        .unwrap();
    let outer = f64::atan2(2.0, -1.0);
    let tip = [1.0 + outer.cos(), outer.sin()];
    let inner = std::f64::consts::FRAC_PI_2 - tip[1].atan2(tip[0]);
    assert!((solution.q[1] - outer).abs() < 1e-12);
    assert!((solution.q[0] - inner).abs() < 1e-12);
}

/// Beyond both limits the nearer end is not the better one: the cost decides.
#[test]
fn clamped_rotation_takes_the_better_limit() {
    let model = planar_arm(&[1.0], Some((-2.9, 0.2)));
    // At 170° from x; the lower limit, −166°, is 24° away, the upper one 158°.
    let target = [f64::cos(2.96), f64::sin(2.96), 0.0];
    let solution = one_sweep()
        .solve(&reach_for(&model, target), &[0.1])
        .unwrap();
    assert_eq!(solution.q[0].to_bits(), (-2.9_f64).to_bits());
}

#[test]
fn prismatic_joint_moves_along_its_axis() {
    let mut builder = Model::builder("gantry");
    let limits = Limits::new(-1.0, 1.0);
    let [x, y, z] = Vector3::UNITS;
    let along = builder.prismatic("along", None, Placement::identity(), x, limits);
    let across = builder.prismatic("across", Some(along), Placement::identity(), y, limits);
    let up = builder.prismatic("up", Some(across), Placement::identity(), -z, limits);
    builder.frame("tip", Some(up), Placement::identity());
    let model = builder.build().unwrap();
    let solution = one_sweep()
        .solve(&reach_for(&model, [0.25, -0.5, 3.0]), &[0.0; 3])
        .unwrap();
    assert_eq!(solution.q, [0.25, -0.5, -1.0]);
    assert_eq!(solution.active_limits().count(), 1);
}

#[test]
fn no_sweep_increases_the_cost() {
    let model = planar_arm(&[0.6, 0.5, 0.4, 0.3], Some((-1.2, 0.9)));
    let mut random = Random::new(5);
    for _ in 0..50 {
        let [x, y, _] = random.vector(1.5).into();
        let problem = reach_for(&model, [x, y, 0.0]);
        let start: Vec<f64> = (0..4).map(|_| random.within(-1.2, 0.9)).collect();
        let mut last = f64::INFINITY;
        let mut observe = |iteration: &Iteration<'_>| {
            assert!(iteration.cost <= last * (1.0 + 1e-12) + 1e-30);
            last = iteration.cost;
            ControlFlow::Continue(())
        };
        let bare = Ccd::default().with_restarts(Restarts::none());
        bare.solve_observed(&problem, &start, &mut observe).unwrap();
    }
}

/// A mimic joint of ratio −0.5 and a locked joint: only the source joint is a variable.
#[test]
fn coupled_and_locked_joints_are_respected() {
    let model = planar_arm(&[1.0, 0.8, 0.6], Some((-2.0, 2.0)));
    let [first, second, third] = [0, 1, 2].map(|k| model.joint(&format!("joint {k}")).unwrap());
    let map = ParameterMap::builder(&model).with_coupled(second, first, -0.5, 0.1);
    let map = map.with_locked(third, 0.4).build().unwrap();
    for master in [-1.3, -0.2, 0.7, 1.6] {
        let goal = [master, 0.1 - 0.5 * master, 0.4];
        let target = planar_tip(&[1.0, 0.8, 0.6], &goal);
        let mut builder = Problem::builder(&model);
        builder.parameters(map.clone());
        builder.add(Point::new(model.frame("tip").unwrap(), target));
        let solution = Ccd::default()
            .solve(&builder.build().unwrap(), &[0.3, 9.0, 9.0])
            .unwrap();
        assert!(solution.reached, "{}", solution.explain());
        assert!((solution.q[0] - master).abs() < 1e-5);
        assert!((solution.q[1] - (0.1 - 0.5 * solution.q[0])).abs() < 1e-15);
        assert_eq!(solution.q[2], 0.4);
    }
}

fn within_limits(model: &Model, solution: &Solution) -> bool {
    let limits = model.limits();
    solution.q.iter().zip(limits).all(|(&v, l)| l.contains(v))
}

fn rig(name: &str) -> Rig {
    let models = concat!(env!("CARGO_MANIFEST_DIR"), "/../models");
    Rig::read(format!("{models}/{name}/{name}.json")).unwrap()
}

/// One tip of each shipped rig with a target from a random pose within limits. The method alone reaches at least nine
/// of ten, and reports the tip's error correctly.
#[test]
fn tips_of_shipped_rigs_are_reached() {
    for (name, tips) in [("robot-arm", 1), ("humanoid", 5)] {
        let rig = rig(name);
        let (skeleton, model) = (&rig.skeleton, rig.skeleton.model());
        let (mut reached, mut count) = (0, 0);
        for seed in 0..60 {
            let pose = skeleton.pose(&model.random_configuration(seed)).unwrap();
            let bone = rig.constrained[seed as usize % tips];
            let target = pose.tip(skeleton, bone).unwrap();
            let mut builder = Problem::builder(model);
            builder.tolerance(Quantity::Metres, 1e-6);
            builder.add(Point::new(skeleton.tip(bone), target));
            let problem = builder.build().unwrap();
            let solution = Ccd::default().solve(&problem, &model.neutral()).unwrap();
            let missed = (skeleton
                .pose(&solution.q)
                .unwrap()
                .tip(skeleton, bone)
                .unwrap()
                - target)
                .norm();
            let reported = solution.tasks().next().unwrap().position_error().unwrap();
            assert!((reported - missed).abs() < 1e-12);
            assert_eq!(solution.reached, missed <= 1e-6);
            assert!(within_limits(model, &solution));
            (reached, count) = (reached + usize::from(solution.reached), count + 1);
        }
        assert!(10 * reached >= 9 * count, "{name}: {reached} of {count}");
    }
}

/// All five tips of the humanoid at once, from poses at 30 % of the way to the limits.
#[test]
fn five_tips_of_the_humanoid_are_reached() {
    let rig = rig("humanoid");
    let (skeleton, model) = (&rig.skeleton, rig.skeleton.model());
    let neutral = model.neutral();
    let mut reached = 0;
    for seed in 0..10 {
        let random_q = model.random_configuration(seed);
        let goal = random_q
            .iter()
            .zip(&neutral)
            .map(|(f, n)| n + 0.3 * (f - n));
        let pose = skeleton.pose(&goal.collect::<Vec<f64>>()).unwrap();
        let mut builder = Problem::builder(model);
        for &tip in &rig.constrained {
            builder.add(Point::new(
                skeleton.tip(tip),
                pose.tip(skeleton, tip).unwrap(),
            ));
        }
        builder.tolerance(Quantity::Metres, 1e-3);
        let problem = builder.build().unwrap();
        let solution = Ccd::default().solve(&problem, &neutral).unwrap();
        reached += usize::from(solution.reached);
        assert!(within_limits(model, &solution));
    }
    assert!(reached >= 8, "{reached} of 10");
}

/// Pose tasks of an arm with a spherical wrist, a shoulder and an elbow, at reachable poses.
#[test]
fn poses_of_an_arm_are_reached() {
    let mut builder = Model::builder("arm");
    let [x, y, z] = Vector3::UNITS;
    let limits = Limits::new(-2.8, 2.8);
    let link = Placement::translation(Vector3::new(0.0, 0.0, 0.4));
    let still = Placement::identity();
    let mut parent = None;
    for (k, (placement, axis)) in [
        (still, z),
        (still, y),
        (link, y),
        (link, z),
        (still, y),
        (still, z),
        (still, x),
    ]
    .into_iter()
    .enumerate()
    {
        let name = format!("joint {k}");
        parent = Some(builder.revolute(name, parent, placement, axis, limits));
    }
    let tip = builder.frame("tip", parent, Placement::translation(z * 0.1));
    let model = builder.build().unwrap();
    let mut kinematics = ForwardKinematics::of_frames(&model, &[tip]).unwrap();
    let mut reached = 0;
    for seed in 0..20 {
        let target = kinematics.place(&model.random_configuration(seed)).unwrap()[0];
        let mut builder = Problem::builder(&model);
        builder.add(FramePose::new(tip, target));
        let problem = builder.build().unwrap();
        let solution = Ccd::default().solve(&problem, &model.neutral()).unwrap();
        assert!(within_limits(&model, &solution));
        reached += usize::from(solution.reached);
    }
    assert!(reached >= 14, "{reached} of 20");
}

#[test]
fn non_finite_targets_end_as_non_finite() {
    let model = planar_arm(&[1.0, 1.0], None);
    let mut builder = Problem::builder(&model);
    let task = builder.add(Point::new(model.frame("tip").unwrap(), [1.0, 1.0, 0.0]));
    let problem = builder.build().unwrap();
    let mut targets = problem.targets();
    targets.get_mut(task).unwrap().set_target([f64::NAN; 3]);
    let question = problem.with_targets(&targets).unwrap();
    let solution = Ccd::default().solve(question, &[0.1, 0.2]).unwrap();
    assert_eq!(solution.termination, Termination::NonFinite);
    assert!(!solution.reached && solution.q == [0.1, 0.2]);
    assert!(Ccd::default().solve(&problem, &[f64::NAN, 0.0]).is_err());
}

/// A joint with a range above one turn near the end of its range. The short rotation to the target leaves the range,
/// the long one does not.
#[test]
fn long_rotation_is_taken_if_the_short_is_blocked() {
    let model = planar_arm(&[1.0], Some((-1.0, 6.0)));
    let target = [f64::cos(0.3), f64::sin(0.3), 0.0];
    let solution = one_sweep().solve(&reach_for(&model, target), &[5.5]);
    let solution = solution.unwrap();
    assert!(
        solution.reached && (solution.q[0] - 0.3).abs() < 1e-12,
        "{:?}",
        solution.q
    );
    let model = planar_arm(&[1.0], Some((-6.0, 1.0)));
    let target = [f64::cos(0.3), f64::sin(-0.3), 0.0];
    let solution = one_sweep().solve(&reach_for(&model, target), &[-5.5]);
    let solution = solution.unwrap();
    assert!(
        solution.reached && (solution.q[0] + 0.3).abs() < 1e-12,
        "{:?}",
        solution.q
    );
}

#[test]
fn overflowing_start_is_not_the_last_attempt() {
    // A prismatic range whose square overflows at the start and at most random samples.
    let long = 2.5e154;
    let mut builder = Model::builder("slide");
    let axis = Vector3::new(1.0, 0.0, 0.0);
    let limits = Limits::new(-long, long);
    let slide = builder.prismatic("slide", None, Placement::identity(), axis, limits);
    let tip = builder.frame("tip", Some(slide), Placement::identity());
    // Random samples are within a few times the model's size.
    let size = Placement::translation([0.0, long, 0.0].into());
    builder.frame("far", Some(slide), size);
    let model = builder.build().unwrap();
    let mut builder = Problem::builder(&model);
    builder.add(Point::new(tip, [1.0, 0.0, 0.0]));
    let problem = builder.build().unwrap();
    let solution = Ccd::default().solve(&problem, &[long]).unwrap();
    assert!(solution.reached && solution.attempts > 1, "{solution:?}");
}

/// One joint between conflicting position and direction. For a rotation about z the sum Σ w² |chord|² is minimal at the
/// angle of Σ w² r² (cos, sin). The lever r is 1 for the direction.
#[test]
fn positions_and_directions_are_weighted() {
    let (lever, weight) = (0.7, 0.4);
    let model = planar_arm(&[lever], None);
    let (angle, direction) = (0.5_f64, -0.3_f64);
    let target = Placement::new(
        kinopt::spatial::Matrix3::identity().rotated_about_z(direction.sin_cos()),
        [lever * angle.cos(), lever * angle.sin(), 0.0].into(),
    );
    let mut builder = Problem::builder(&model);
    let pose = Task::new(FramePose::new(model.frame("tip").unwrap(), target));
    let pose = pose.weight(Quantity::Metres, 1.0);
    builder.add(pose.weight(Quantity::Radians, weight));
    let problem = builder.build().unwrap();
    let solution = one_sweep().solve(&problem, &[0.2]).unwrap();
    let sum = |component: fn(f64) -> f64| {
        lever * lever * component(angle) + weight * weight * component(direction)
    };
    let expected = sum(f64::sin).atan2(sum(f64::cos));
    assert!(
        (solution.q[0] - expected).abs() < 1e-12,
        "{:?} {expected}",
        solution.q
    );
}

/// A mimic joint of ratio −½ outside its source joint's chain is moved by its source joint.
#[test]
fn mimic_joint_moves_by_its_source_joint() {
    let mut builder = Model::builder("follower");
    let z = Vector3::new(0.0, 0.0, 1.0);
    let limits = Limits::new(-1.0, 1.0);
    let none = Placement::identity();
    let leader = builder.revolute("leader", None, none, z, limits);
    let hand = builder.revolute("hand", None, none, z, limits);
    let link = Placement::translation([1.0, 0.0, 0.0].into());
    builder.frame("tip", Some(hand), link);
    let model = builder.build().unwrap();
    let map = ParameterMap::builder(&model).with_coupled(hand, leader, -0.5, 0.1);
    let map = map.build().unwrap();
    // Within its range, and at its end.
    for (angle, expected) in [(0.4_f64, 0.4), (0.9, 0.6), (-0.2, -0.2)] {
        let mut builder = Problem::builder(&model);
        builder.parameters(map.clone());
        let target = [angle.cos(), angle.sin(), 0.0];
        builder.add(Point::new(model.frame("tip").unwrap(), target));
        let problem = builder.build().unwrap();
        let solution = one_sweep().solve(&problem, &[0.2, 0.0]).unwrap();
        assert!((solution.q[1] - expected).abs() < 1e-12, "{:?}", solution.q);
        assert!((solution.q[0] + 2.0 * (expected - 0.1)).abs() < 1e-12);
    }
}

/// A mimic joint of ratio 0 stays at its offset, and the joints before it compensate.
#[test]
fn mimic_joint_of_ratio_zero_is_fixed() {
    let mut builder = Model::builder("follower");
    let z = Vector3::new(0.0, 0.0, 1.0);
    let limits = Limits::new(-2.0, 2.0);
    let none = Placement::identity();
    let link = Placement::translation([1.0, 0.0, 0.0].into());
    let leader = builder.revolute("leader", None, none, z, limits);
    let arm = builder.revolute("arm", None, none, z, limits);
    let hand = builder.revolute("hand", Some(arm), link, z, limits);
    builder.frame("tip", Some(hand), link);
    let model = builder.build().unwrap();
    let map = ParameterMap::builder(&model).with_coupled(hand, leader, 0.0, 0.3);
    let mut builder = Problem::builder(&model);
    builder.parameters(map.build().unwrap());
    let target = planar_tip(&[1.0, 1.0], &[0.7, 0.3]);
    builder.add(Point::new(model.frame("tip").unwrap(), target));
    let problem = builder.build().unwrap();
    let solution = one_sweep().solve(&problem, &[0.2, -0.5, 0.0]).unwrap();
    assert!(solution.reached, "{}", solution.explain());
    for (q, expected) in solution.q.iter().zip([0.2, 0.7, 0.3]) {
        assert!((q - expected).abs() < 1e-12, "{:?}", solution.q);
    }
}

/// Σ w² (s − d)² is minimal at the weighted mean, for any weights.
#[test]
fn prismatic_joint_moves_to_the_weighted_mean() {
    let mut builder = Model::builder("slide");
    let (x, limits) = (Vector3::new(1.0, 0.0, 0.0), Limits::new(-5.0, 5.0));
    let slide = builder.prismatic("slide", None, Placement::identity(), x, limits);
    let [one, other] =
        ["one", "other"].map(|name| builder.frame(name, Some(slide), Placement::identity()));
    let model = builder.build().unwrap();
    let mut tasks = Problem::builder(&model);
    let goals = [(one, 0.8, 2.0), (other, -0.7, 0.5)];
    for (frame, position, weight) in goals {
        tasks.add(Task::new(Point::new(frame, [position, 0.0, 0.0])).scale(weight));
    }
    let problem = tasks.build().unwrap();
    let solution = one_sweep().solve(&problem, &[0.2]).unwrap();
    let sum = |term: fn((f64, f64)) -> f64| -> f64 { goals.iter().map(|a| term((a.1, a.2))).sum() };
    let expected =
        sum(|(position, weight)| weight * weight * position) / sum(|(_, weight)| weight * weight);
    assert!(
        (solution.q[0] - expected).abs() < 1e-12,
        "{:?} {expected}",
        solution.q
    );
}

/// A joint that moves to its limit is exactly at it, despite rounding.
#[test]
fn limit_is_reached_exactly() {
    let mut random = Random::new(3);
    for _ in 0..200 {
        let upper = random.within(0.1, 1.0);
        let model = planar_arm(&[1.0], Some((-upper, upper)));
        for end in [-upper, upper] {
            let target = [(1.5 * end).cos(), (1.5 * end).sin(), 0.0];
            let start = random.within(-upper, upper);
            let solution = one_sweep()
                .solve(&reach_for(&model, target), &[start])
                .unwrap();
            assert_eq!(solution.q[0].to_bits(), end.to_bits(), "from {start}");
            assert_eq!(solution.active_limits().count(), 1);
        }
    }
}

/// A pose of a tool equals a pose of a frame at the tool.
#[test]
fn tool_equals_a_frame_at_the_tip() {
    let mut random = Random::new(47);
    let limits = Limits::new(-2.5, 2.5);
    let mut builder = Model::builder("arm");
    let mut parent = None;
    for k in 0..6 {
        let at = support::placement(&random.rigid(0.4));
        let axis = support::vector(random.direction().into_inner());
        parent = Some(builder.revolute(format!("joint {k}"), parent, at, axis, limits));
    }
    let tool = support::placement(&random.rigid(0.3));
    let tip = builder.frame("tip", parent, Placement::identity());
    let at_tool = builder.frame("tool", parent, tool);
    let model = builder.build().unwrap();
    let mut kinematics = ForwardKinematics::of_frames(&model, &[at_tool]).unwrap();
    let stopping = Stopping::default().with_max_iterations(3);
    let ccd = Ccd::default().with_restarts(Restarts::none());
    let ccd = ccd.with_stopping(stopping);
    for seed in 0..10 {
        let target = kinematics.place(&model.random_configuration(seed)).unwrap()[0];
        let [by_tool, by_frame] = [
            FramePose::new(tip, target).with_tool(tool),
            FramePose::new(at_tool, target),
        ]
        .map(|pose| {
            let mut builder = Problem::builder(&model);
            builder.add(pose);
            builder.build().unwrap()
        });
        let [a, b] =
            [&by_tool, &by_frame].map(|problem| ccd.solve(problem, &model.neutral()).unwrap().q);
        let deviation = a.iter().zip(&b).map(|(a, b)| (a - b).abs());
        let deviation = deviation.fold(0.0, f64::max);
        assert!(deviation < 1e-9, "{seed}: {deviation:e}");
    }
}
