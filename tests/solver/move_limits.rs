//! Promise: no joint moves farther from its start than the move limit; ball joints are limited by rotation angle. The
//! closest result within the limit is found, and the active limit is named. A ball joint with a total angle limit
//! behaves the same way.

use std::f64::consts::PI;

use kinopt::ik::{BoundKind, Drag, MoveLimits, SolveError};
use kinopt::model::{BallLimits, FrameId, Limits, Model, ParameterMap};
use kinopt::problem::{Derivatives, Evaluation, ProblemInstance};
use kinopt::solver::{LeastSquares, Side};
use kinopt::spatial::{Matrix3, Placement, Vector3};
use kinopt::task::{FramePose, Orientation, Point};
use kinopt::{Problem, Solver};
use nalgebra as na;
use support::configuration_rules::angle_between;
use support::figures::{Figure, unit};
use support::random::Random;
use support::{placement, vector};

const X: Vector3<f64> = Vector3 {
    x: 1.0,
    y: 0.0,
    z: 0.0,
};

/// Hand at 1 m from a ball joint.
fn shoulder(limits: Option<BallLimits>) -> (Model, FrameId) {
    let mut builder = Model::builder("arm");
    let ball = builder.ball("shoulder", None, Placement::identity(), X, limits);
    let hand = builder.frame("hand", Some(ball), Placement::translation(X));
    (builder.build().unwrap(), hand)
}

fn turned_to(model: &Model, hand: FrameId, target: na::UnitQuaternion<f64>) -> Problem {
    let mut tasks = Problem::builder(model);
    tasks.add(Orientation::new(
        hand,
        Matrix3::from(target.to_rotation_matrix()),
    ));
    tasks.build().unwrap()
}

fn quaternion(q: na::UnitQuaternion<f64>) -> [f64; 4] {
    [q.w, q.i, q.j, q.k]
}

fn random_turn(random: &mut Random, max_angle: f64) -> na::UnitQuaternion<f64> {
    na::UnitQuaternion::from_axis_angle(&random.direction(), random.within(0.0, max_angle))
}

#[test]
fn move_limited_ball_follows_the_geodesic() {
    let cone = BallLimits::elliptic([0.0, 0.0, 1.0], [2.5, 2.8], Limits::new(-2.5, 2.6));
    for limits in [None, Some(cone)] {
        let (model, hand) = shoulder(limits);
        let random = &mut Random::new(5);
        for case in 0..60 {
            let start = random_turn(random, 1.0);
            let rotation = random_turn(random, 1.0);
            let most = random.within(0.01, 0.9) * rotation.angle();
            let problem = turned_to(&model, hand, start * rotation);
            let from = quaternion(start);
            let moves = MoveLimits::new(&problem, &[most; 4], &from).unwrap();
            let question = ProblemInstance::from(&problem).with_moves(&moves).unwrap();
            let solution = Solver::default().solve_once(question, &from).unwrap();
            assert!(!solution.reached);
            // On the geodesic, at the limited angle.
            let nearest = start * rotation.powf(most / rotation.angle());
            let deviation = nearest.angle_to(&unit(&solution.q));
            assert!(
                deviation < 1e-6,
                "case {case}: {deviation:e} off\n{}",
                solution.explain()
            );
            let moved = angle_between(&from, &solution.q);
            assert!(
                moved <= most + 1e-14 && moved > most - 1e-9,
                "{moved} of {most}"
            );
            let held: Vec<_> = solution.active_limits().collect();
            assert_eq!(held.len(), 1, "{}", solution.explain());
            assert_eq!(
                (held[0].joint, held[0].kind, held[0].side, held[0].value),
                ("shoulder", BoundKind::Move, Side::Upper, most)
            );
        }
    }
}

#[test]
fn total_angle_limit_is_equal_for_all_axes() {
    for most in [0.05, 1.0, 3.0] {
        let (model, hand) = shoulder(Some(BallLimits::within_angle(most)));
        let random = &mut Random::new(6);
        for _ in 0..30 {
            let axis = random.direction();
            let target = na::UnitQuaternion::from_axis_angle(&axis, random.within(most, PI - 0.01));
            let problem = turned_to(&model, hand, target);
            let start = model.random_configuration(random.bits());
            let solution = Solver::default().solve_once(&problem, &start).unwrap();
            let nearest = na::UnitQuaternion::from_axis_angle(&axis, most);
            let deviation = nearest.angle_to(&unit(&solution.q));
            assert!(
                deviation < 1e-6,
                "{deviation:e} off\n{}",
                solution.explain()
            );
            assert!(model.is_within_limits(&solution.q));
            let held: Vec<_> = solution.active_limits().collect();
            assert_eq!((held[0].joint, held[0].value), ("shoulder", most));
            assert_eq!(held[0].kind, BoundKind::Limit);
        }
    }
}

#[test]
fn total_angle_and_cone_hold_together() {
    // Beyond the cone and the total angle: the closest rotation is where both edges meet, a swing about z and a twist.
    let limits = BallLimits::cone(0.8, Limits::new(-1.0, 1.0)).with_angle(1.0);
    let (model, hand) = shoulder(Some(limits));
    let swing = |angle| na::UnitQuaternion::from_axis_angle(&na::Vector3::z_axis(), angle);
    let twist = |angle| na::UnitQuaternion::from_axis_angle(&na::Vector3::x_axis(), angle);
    let problem = turned_to(&model, hand, swing(1.4) * twist(0.9));
    let solution = Solver::default()
        .solve_once(&problem, &model.neutral())
        .unwrap();
    assert!(model.is_within_limits(&solution.q), "{:?}", solution.q);
    // cos ½angle = cos ½swing · cos ½twist.
    let twist_angle = 2.0 * (0.5_f64.cos() / 0.4_f64.cos()).acos();
    let nearest = swing(0.8) * twist(twist_angle);
    let cost = |q: na::UnitQuaternion<f64>| q.angle_to(&(swing(1.4) * twist(0.9)));
    let reached_cost = cost(unit(&solution.q));
    assert!(
        reached_cost <= cost(nearest) + 1e-9,
        "{reached_cost} above {}",
        cost(nearest)
    );
    // No neighbour within both limits is closer.
    let random = &mut Random::new(7);
    for _ in 0..20_000 {
        let near = unit(&solution.q) * random_turn(random, 1e-2);
        if model.is_within_limits(&quaternion(near)) {
            assert!(
                cost(near) >= reached_cost - 1e-7,
                "{} below {reached_cost}",
                cost(near)
            );
        }
    }
    let held: Vec<_> = solution
        .active_limits()
        .map(|limit| limit.joint.to_owned())
        .collect();
    assert!(held.contains(&"shoulder".to_owned()), "{held:?}");
}

#[test]
fn scalar_and_mimic_joints_keep_move_limits() {
    let mut builder = Model::builder("gripper");
    let at = Placement::identity();
    let z = Vector3::UNITS[2];
    let limits = Limits::new(-2.0, 2.0);
    let arm = builder.prismatic("slide", None, at, X, limits);
    let hinge = builder.revolute("hinge", Some(arm), at, z, limits);
    let follower = builder.revolute("follower", Some(hinge), at, z, limits);
    let hand = builder.frame("hand", Some(follower), Placement::translation(X));
    let model = builder.build().unwrap();
    let map = ParameterMap::builder(&model).with_coupled(follower, hinge, -2.0, 0.1);
    let mut tasks = Problem::builder(&model);
    tasks.parameters(map.build().unwrap());
    tasks.add(Point::new(hand, [1.5, -1.9, 0.0]));
    let problem = tasks.build().unwrap();
    let start = [0.2, 0.3, -0.5];
    // The mimic joint's limit of 0.1 limits its source joint to 0.05.
    let moves = MoveLimits::new(&problem, &[0.05, 1.0, 0.1], &start).unwrap();
    let question = ProblemInstance::from(&problem).with_moves(&moves).unwrap();
    let solution = Solver::default().solve_once(question, &start).unwrap();
    let moved: Vec<f64> = solution.q.iter().zip(start).map(|(a, b)| a - b).collect();
    assert!((moved[0].abs() - 0.05).abs() < 1e-12, "{moved:?}");
    assert!(
        (moved[1] - 0.05).abs() < 1e-12 && (moved[2] + 0.1).abs() < 1e-12,
        "{moved:?}"
    );
    let kinds = solution
        .active_limits()
        .map(|limit| (limit.joint, limit.kind));
    let held: Vec<_> = kinds.collect();
    assert_eq!(
        held,
        [("slide", BoundKind::Move), ("hinge", BoundKind::Move)]
    );
    assert!(solution.explain().contains("end of the allowed move"));
}

/// The tighter limit of the two applies, for either order of the joints in the model.
#[test]
fn source_joint_keeps_the_tighter_move_limit() {
    let z = Vector3::UNITS[2];
    for leader_first in [true, false] {
        let mut builder = Model::builder("two hinges");
        let (at, limits) = (Placement::identity(), Limits::new(-2.0, 2.0));
        let one = builder.revolute("one", None, at, z, limits);
        let two = builder.revolute("two", Some(one), at, z, limits);
        let hand = builder.frame("hand", Some(two), Placement::translation(X));
        let model = builder.build().unwrap();
        let (leader, follower) = if leader_first { (one, two) } else { (two, one) };
        let map = ParameterMap::builder(&model).with_coupled(follower, leader, 2.0, 0.0);
        let mut tasks = Problem::builder(&model);
        tasks.parameters(map.build().unwrap());
        tasks.add(Point::new(hand, [0.0, 1.0, 0.0]));
        let problem = tasks.build().unwrap();
        for (leader_limit, follower_limit, goes) in [(0.03, 0.1, 0.03), (0.1, 0.1, 0.05)] {
            let most = if leader_first {
                [leader_limit, follower_limit]
            } else {
                [follower_limit, leader_limit]
            };
            let moves = MoveLimits::new(&problem, &most, &[0.0; 2]).unwrap();
            let question = ProblemInstance::from(&problem).with_moves(&moves).unwrap();
            let solution = Solver::default().solve_once(question, &[0.0; 2]).unwrap();
            let moved = solution.q[usize::from(!leader_first)];
            assert!((moved - goes).abs() < 1e-12, "{most:?}: {moved}");
        }
    }
}

/// Includes a ball joint that starts far out in swing and twist and rotates a little from there.
#[test]
fn projection_stays_within_the_move_limit() {
    let cone = BallLimits::elliptic([0.0, 0.0, 1.0], [2.8, 2.5], Limits::new(-3.0, 3.0));
    for limits in [None, Some(cone)] {
        let (model, hand) = shoulder(limits);
        let problem = turned_to(&model, hand, na::UnitQuaternion::identity());
        let random = &mut Random::new(9);
        let (mut q, mut centre) = (model.neutral(), [0.0; 3]);
        let mut nearly = 0;
        for case in 0..60 {
            let start = model.random_configuration(case);
            problem.parameters().reduce(&start, &mut centre).unwrap();
            let most = random.within(0.05, 0.8);
            let moves = MoveLimits::new(&problem, &[most; 4], &start).unwrap();
            let question = ProblemInstance::from(&problem).with_moves(&moves).unwrap();
            for _ in 0..200 {
                let mut x = centre.map(|at| at + random.within(-most, most));
                question.space().project(&mut x);
                problem.parameters().expand(&x, &mut q).unwrap();
                let moved = angle_between(&start, &q);
                assert!(moved <= most + 1e-12, "case {case}: {moved} of {most}");
                nearly += usize::from(moved > 0.99 * most);
            }
        }
        assert!(nearly > 1000, "{nearly}");
    }
}

#[test]
fn derivatives_agree_at_a_move_limit() {
    for seed in 0..8 {
        let figure = Figure::new(seed, 7);
        let model = &figure.model;
        let random = &mut Random::new(seed);
        let mut tasks = Problem::builder(model);
        for &frame in &figure.frames {
            tasks.add(FramePose::new(frame, placement(&random.rigid(0.5))));
        }
        let problem = tasks.build().unwrap();
        let start = model.random_configuration(seed);
        let most = vec![0.3; start.len()];
        let moves = MoveLimits::new(&problem, &most, &start).unwrap();
        let mut x: Vec<f64> = (0..problem.variables())
            .map(|_| random.within(-3.0, 3.0))
            .collect();
        ProblemInstance::from(&problem)
            .with_moves(&moves)
            .unwrap()
            .space()
            .project(&mut x);
        let jacobians = Derivatives::ALL.map(|route| {
            let problem = problem.clone().with_derivatives(route);
            let question = ProblemInstance::from(&problem).with_moves(&moves).unwrap();
            let mut scratch = problem.scratch();
            let mut jacobian =
                na::DMatrix::from_element(problem.rows(), problem.variables(), f64::NAN);
            Evaluation::new(question, &mut scratch).jacobian(&x, &mut jacobian);
            jacobian
        });
        let size = jacobians[0].amax().max(1.0);
        for (route, jacobian) in Derivatives::ALL.iter().zip(&jacobians) {
            let deviation = (jacobian - &jacobians[0]).amax();
            assert!(
                deviation < 1e-6 * size,
                "seed {seed}, {route:?}: {deviation:e}"
            );
        }
    }
}

#[test]
fn drag_frame_rotates_ball_by_the_move_limit() {
    let (model, hand) = shoulder(None);
    let mut tasks = Problem::builder(&model);
    let axis = na::Unit::new_normalize(na::Vector3::new(1.0, 2.0, -1.0));
    let target = na::UnitQuaternion::from_axis_angle(&axis, 2.0);
    tasks.add(Orientation::new(
        hand,
        Matrix3::from(target.to_rotation_matrix()),
    ));
    let mut drag = Drag::new(tasks.build().unwrap(), &model.neutral()).unwrap();
    drag = drag.with_max_move(0.1).unwrap();
    for frame in 1..20 {
        drag.advance();
        let target = na::UnitQuaternion::from_axis_angle(&axis, 0.1 * f64::from(frame));
        assert!(target.angle_to(&unit(drag.q())) < 1e-6, "frame {frame}");
        assert!(drag.is_speed_limited());
    }
    drag.advance();
    assert!(drag.solution().reached && drag.jump().is_none());
}

/// A ball joint under a zero move limit rotates again after the limit grows.
#[test]
fn drag_moves_again_after_limit_grows() {
    let (model, hand) = shoulder(None);
    let target = na::UnitQuaternion::from_axis_angle(&na::Vector3::z_axis(), 1.0);
    let start = model.neutral();
    let drag = Drag::new(turned_to(&model, hand, target), &start).unwrap();
    let mut drag = drag.with_max_move(1e-13).unwrap();
    drag.advance();
    assert_eq!(drag.q(), start);
    let mut drag = drag.with_max_move(0.2).unwrap();
    drag.advance();
    let turned = angle_between(&start, drag.q());
    assert!((turned - 0.2).abs() < 1e-9, "{turned}");
}

#[test]
fn invalid_move_limits_are_named_in_errors() {
    let (model, hand) = shoulder(None);
    let mut tasks = Problem::builder(&model);
    tasks.add(Point::new(hand, vector(na::Vector3::y())));
    let problem = tasks.build().unwrap();
    let start = model.neutral();
    let refused = |most: &[f64]| MoveLimits::new(&problem, most, &start).unwrap_err();
    assert!(matches!(
        refused(&[0.1; 3]),
        SolveError::MovesLength {
            given: 3,
            expected: 4,
            ..
        }
    ));
    for invalid in [-0.1, f64::NAN] {
        assert!(refused(&[invalid; 4]).to_string().contains("max_move"));
    }
    assert!(
        refused(&[0.1, 0.1, 0.1, 0.2])
            .to_string()
            .contains("`shoulder`")
    );
    let zero = MoveLimits::new(&problem, &[0.1; 4], &[0.0; 4]).unwrap_err();
    assert!(matches!(zero, SolveError::StartNoRotation { .. }));
    assert!(MoveLimits::by_angle(&problem, 0.0, &start).is_err());
    let moves = MoveLimits::new(&problem, &[0.0; 4], &start).unwrap();
    let question = ProblemInstance::from(&problem).with_moves(&moves).unwrap();
    let still = Solver::default().solve_once(question, &start).unwrap();
    assert_eq!(still.q, start);

    let other = support::planar_arm(&[1.0, 1.0], None);
    let mut tasks = Problem::builder(&other);
    tasks.add(Point::new(other.frame("tip").unwrap(), [1.0, 0.0, 0.0]));
    let other = tasks.build().unwrap();
    let foreign = ProblemInstance::from(&other)
        .with_moves(&moves)
        .unwrap_err();
    assert!(matches!(
        foreign,
        SolveError::ForeignMoves {
            given: 3,
            expected: 2,
            ..
        }
    ));
}

#[test]
fn move_limits_never_violate_the_total_angle() {
    // Beyond a right angle, where straight segments between valid rotations leave the set. Twists exceed one turn,
    // where the variables of a rotation are ambiguous.
    let limits = BallLimits::cone(2.0, Limits::UNBOUNDED).with_angle(1.7);
    let (model, hand) = shoulder(Some(limits));
    let problem = turned_to(&model, hand, na::UnitQuaternion::identity());
    let random = &mut Random::new(8);
    let mut q = model.neutral();
    for case in 0..40 {
        let start = quaternion(random_turn(random, 9.0));
        let moves = MoveLimits::new(&problem, &[0.3; 4], &start).unwrap();
        let question = ProblemInstance::from(&problem).with_moves(&moves).unwrap();
        for _ in 0..400 {
            let mut x = [2.0, 2.0, 9.0].map(|size| random.within(-size, size));
            question.space().project(&mut x);
            problem.parameters().expand(&x, &mut q).unwrap();
            assert!(model.is_within_limits(&q), "case {case}: {q:?}");
        }
    }
}
