//! Promise: models with free and ball joints are solved like all others. Reachable targets are reached, all derivative
//! routes agree, and no cone, twist, base bound or joint limit is violated. The blocking limit is named.

use std::f64::consts::PI;

use kinopt::ik::{Drag, Restarts, Side};
use kinopt::model::{BallLimits, Limits, Model, ParameterMap};
use kinopt::problem::{Derivatives, Evaluation};
use kinopt::solver::{LeastSquares, Stopping};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{FramePose, Orientation, Point, Posture, Smoothness};
use kinopt::{Problem, Solver, Workspace};
use nalgebra::DMatrix;
use support::figures::{Figure, Kind};
use support::methods::solvers;
use support::placement;
use support::random::{Random, part};

/// The last frame's pose and another frame's point at a random configuration, or up to `off` metres away.
fn problem(figure: &Figure, seed: u64, off: f64) -> Problem {
    let random = &mut Random::new(seed);
    let q = figure.model.random_configuration(seed + 1000);
    let at = figure.frames_at(&q);
    let (last, other) = (figure.frames.len() - 1, figure.frames.len() / 2);
    let mut builder = Problem::builder(&figure.model);
    let mut target = at[last];
    target.translation.vector += random.vector(off);
    builder.add(FramePose::new(figure.frames[last], placement(&target)));
    let position = at[other].translation.vector + random.vector(off);
    builder.add(Point::new(figure.frames[other], support::vector(position)));
    builder.build().unwrap()
}

#[test]
fn targets_of_a_configuration_are_reached() {
    let mut workspace = Workspace::new();
    for seed in part(0..400_u64, 11) {
        let figure = Figure::new(seed % 20, 5 + (seed % 4) as usize);
        let problem = problem(&figure, seed, 0.0);
        let start = figure.model.neutral();
        let solution = Solver::default()
            .solve(&problem, &start, &mut workspace)
            .unwrap();
        assert!(solution.reached, "seed {seed}: {}", solution.explain());
        assert_eq!(figure.broken(&solution.q), None, "seed {seed}");
        let at = figure.frames_at(&solution.q);
        let q = figure.model.random_configuration(seed + 1000);
        let last = figure.frames.len() - 1;
        let missed =
            (at[last].translation.vector - figure.frames_at(&q)[last].translation.vector).norm();
        assert!(
            missed < 1e-5,
            "seed {seed}: said to be reached {missed} off"
        );
    }
}

#[test]
fn no_solution_violates_a_limit() {
    let mut workspace = Workspace::new();
    for seed in part(0..300_u64, 13) {
        let figure = Figure::new(seed % 30, 4 + (seed % 5) as usize);
        let model = &figure.model;
        let problem = problem(&figure, seed, [0.0, 0.3, 2.0][(seed % 3) as usize]);
        // Violates all limits: arbitrary quaternions and revolute joints out of range.
        let random = &mut Random::new(seed);
        let start: Vec<f64> = (0..model.configuration_len())
            .map(|_| random.within(-3.0, 3.0))
            .collect();
        for solver in solvers() {
            let stopping = Stopping::default().with_max_iterations(30);
            let solver = solver
                .with_restarts(Restarts::default().with_attempts(3))
                .with_stopping(stopping);
            let solution = solver.solve(&problem, &start, &mut workspace).unwrap();
            assert_eq!(
                figure.broken(&solution.q),
                None,
                "seed {seed}, {}",
                solver.method()
            );
            assert!(model.is_within_limits(&solution.q));
        }
    }
}

pub(crate) fn jacobian(problem: &Problem, route: Derivatives, x: &[f64]) -> DMatrix<f64> {
    let problem = &problem.clone().with_derivatives(route);
    let mut scratch = problem.scratch();
    let mut jacobian = DMatrix::from_element(problem.rows(), problem.variables(), f64::NAN);
    Evaluation::new(problem, &mut scratch).jacobian(x, &mut jacobian);
    jacobian
}

#[test]
fn derivative_routes_agree_at_special_rotations() {
    for seed in 0..12 {
        let figure = Figure::new(seed, 8);
        let model = &figure.model;
        let random = &mut Random::new(seed);
        let reference = model.random_configuration(seed + 7);
        let mut builder = Problem::builder(model);
        let map = ParameterMap::free(model);
        builder.parameters(map.clone());
        for &frame in &figure.frames {
            builder.add(FramePose::new(frame, placement(&random.rigid(0.5))));
        }
        builder.add(Posture::new(model, &reference));
        builder.add(Smoothness::new(model, &reference, 0.1));
        let problem = builder.build().unwrap();
        let mut x = vec![0.0; problem.variables()];
        for case in 0..4 {
            let mut q = match case {
                0 => model.neutral(),
                _ => model.random_configuration(seed + case),
            };
            if case == 2 {
                // 1e-9 rad short of half a turn, about any axis.
                let axis = random.direction();
                let half = 0.5 * (PI - 1e-9);
                q[3] = half.cos();
                for k in 0..3 {
                    q[4 + k] = half.sin() * axis[k];
                }
            }
            map.reduce(&q, &mut x).unwrap();
            if case == 3 {
                // Far outside: projection puts it on the edges.
                x.iter_mut().for_each(|value| *value *= 9.0);
                kinopt::problem::ProblemInstance::from(&problem)
                    .space()
                    .project(&mut x);
            }
            let analytic = jacobian(&problem, Derivatives::Analytic, &x);
            let dual = jacobian(&problem, Derivatives::Dual, &x);
            let central = jacobian(&problem, Derivatives::CentralDifference, &x);
            let size = dual.amax().max(1.0);
            assert!(
                (&analytic - &dual).amax() < 1e-11 * size,
                "seed {seed}, case {case}"
            );
            let deviation = (&analytic - &central).amax();
            assert!(
                deviation < 1e-7 * size,
                "seed {seed}, case {case}: {deviation:e}"
            );

            let mut scratch = problem.scratch();
            let mut evaluation = Evaluation::new(&problem, &mut scratch);
            let mut residual = vec![0.0; evaluation.rows()];
            evaluation.residual(&x, &mut residual);
            let mut gradient = vec![0.0; x.len()];
            let mut buffer = DMatrix::zeros(residual.len(), x.len());
            evaluation.gradient(&x, &residual, &mut gradient, &mut buffer);
            let product = dual.transpose() * nalgebra::DVector::from_vec(residual);
            let scale = product.amax().max(1.0);
            for (ours, theirs) in gradient.iter().zip(&product) {
                assert!((ours - theirs).abs() < 1e-11 * scale);
            }
        }
    }
}

/// Upper arm of 1 m on a shoulder with a cone of 1 rad about its x axis and a twist of ±0.5 rad.
fn shoulder() -> (Model, kinopt::model::FrameId) {
    let mut builder = Model::builder("arm");
    let along = Vector3::new(1.0, 0.0, 0.0);
    let limits = BallLimits::cone(1.0, Limits::new(-0.5, 0.5));
    let shoulder = builder.ball(
        "left_shoulder",
        None,
        Placement::identity(),
        along,
        Some(limits),
    );
    let hand = builder.frame("hand", Some(shoulder), Placement::translation(along));
    (builder.build().unwrap(), hand)
}

#[test]
fn swing_beyond_cone_ends_at_its_edge() {
    let (model, hand) = shoulder();
    for angle in [0.0_f64, 0.7, 2.0, 4.0] {
        let mut builder = Problem::builder(&model);
        // Perpendicular to the cone's axis: the closest swing is 1 rad.
        builder.add(Point::new(hand, [0.0, angle.cos(), angle.sin()]));
        let problem = builder.build().unwrap();
        let solution = Solver::default()
            .solve_once(&problem, &model.neutral())
            .unwrap();
        assert!(!solution.reached);
        // Chord over the rest of the right angle.
        let missed = 2.0 * (0.5 * (0.5 * PI - 1.0)).sin();
        let error = solution.position_error().unwrap();
        assert!((error - missed).abs() < 1e-9, "{error} instead of {missed}");
        let limits: Vec<_> = solution.active_limits().collect();
        assert_eq!(limits.len(), 1, "{}", solution.explain());
        assert_eq!(
            (limits[0].joint, limits[0].side),
            ("left_shoulder swing", Side::Upper)
        );
        assert!((limits[0].value - 1.0).abs() < 1e-9);
    }
}

#[test]
fn twist_beyond_limit_is_clamped_and_named() {
    let (model, hand) = shoulder();
    let mut builder = Problem::builder(&model);
    let turned = nalgebra::Rotation3::from_axis_angle(&nalgebra::Vector3::x_axis(), -1.2);
    builder.add(Orientation::new(
        hand,
        kinopt::spatial::Matrix3::from(turned),
    ));
    let problem = builder.build().unwrap();
    let solution = Solver::default()
        .solve_once(&problem, &model.neutral())
        .unwrap();
    assert!((solution.orientation_error().unwrap() - 0.7).abs() < 1e-9);
    let limits: Vec<_> = solution.active_limits().collect();
    assert_eq!(
        (limits[0].joint, limits[0].side),
        ("left_shoulder twist", Side::Lower)
    );
}

#[test]
fn active_limit_names_the_right_ball_joint() {
    let mut builder = Model::builder("arms");
    let (origin, along) = (Placement::identity(), Vector3::UNITS[0]);
    let limits = || Some(BallLimits::cone(1.0, Limits::new(-0.5, 0.5)));
    let hands = ["first", "second"].map(|name| {
        let shoulder = builder.ball(name, None, origin, along, limits());
        builder.frame(format!("{name} hand"), Some(shoulder), origin)
    });
    let model = builder.build().unwrap();
    let turned = nalgebra::Rotation3::from_axis_angle(&nalgebra::Vector3::x_axis(), -1.2);
    let turned = kinopt::spatial::Matrix3::from(turned);
    for (hand, named) in hands.into_iter().zip(["first twist", "second twist"]) {
        let mut tasks = Problem::builder(&model);
        tasks.add(Orientation::new(hand, turned));
        let solution = Solver::default().solve_once(&tasks.build().unwrap(), &model.neutral());
        let solution = solution.unwrap();
        let reported = solution.active_limits().map(|limit| limit.joint.to_owned());
        assert_eq!(reported.collect::<Vec<_>>(), [named]);
    }
}

/// Excessive twist and total angle: both limits are active, each with its side and value.
#[test]
fn twist_and_total_angle_are_both_active() {
    let x = Vector3::UNITS[0];
    for (twist, side) in [(-2.4, Side::Lower), (2.4, Side::Upper)] {
        let mut builder = Model::builder("arm");
        let limits = BallLimits::cone(3.0, Limits::new(-0.5, 0.5)).with_angle(0.8);
        let still = Placement::identity();
        let shoulder = builder.ball("shoulder", None, still, x, Some(limits));
        let hand = builder.frame("hand", Some(shoulder), still);
        let model = builder.build().unwrap();
        let (y, x) = (nalgebra::Vector3::y_axis(), nalgebra::Vector3::x_axis());
        let turned = nalgebra::Rotation3::from_axis_angle(&y, 1.2)
            * nalgebra::Rotation3::from_axis_angle(&x, twist);
        let mut tasks = Problem::builder(&model);
        tasks.add(Orientation::new(
            hand,
            kinopt::spatial::Matrix3::from(turned),
        ));
        let problem = tasks.build().unwrap();
        let solution = Solver::default().solve_once(&problem, &model.neutral());
        let solution = solution.unwrap();
        assert!(!solution.reached);
        let limits = solution.active_limits();
        let reported: Vec<_> = limits.map(|limit| (limit.joint, limit.side)).collect();
        assert!(reported.contains(&("shoulder twist", side)), "{reported:?}");
        let limits = solution.active_limits();
        let mut values: Vec<_> = limits.map(|limit| limit.value.abs()).collect();
        values.sort_by(f64::total_cmp);
        assert_eq!(values.len(), 2, "{}", solution.explain());
        assert!((values[0] - 0.5).abs() < 1e-6 && (values[1] - 0.8).abs() < 1e-6);
    }
}

#[test]
fn ball_rotation_in_a_drag_frame_is_bounded() {
    for seed in 0..10 {
        let figure = Figure::new(seed, 6);
        let model = &figure.model;
        let problem = problem(&figure, seed, 1.0);
        let mut drag = Drag::new(problem, &model.random_configuration(seed)).unwrap();
        drag = drag.with_max_move(0.1).unwrap();
        let mut before = drag.q().to_vec();
        let mut v = vec![0.0; model.degrees_of_freedom()];
        for _ in 0..40 {
            drag.advance();
            assert_eq!(figure.broken(drag.q()), None);
            model.difference(&before, drag.q(), &mut v).unwrap();
            let mut at = 0;
            for part in &figure.parts {
                let turned = match &part.kind {
                    Kind::Free(_) => Some(&v[at + 3..at + 6]),
                    Kind::Ball(_) => Some(&v[at..at + 3]),
                    _ => None,
                };
                let angle = turned.map_or(0.0, |v| v.iter().map(|v| v * v).sum::<f64>().sqrt());
                assert!(angle <= 0.1 + 1e-9, "{} turned by {angle}", part.name);
                at += match &part.kind {
                    Kind::Free(_) => 6,
                    Kind::Ball(_) => 3,
                    _ => 1,
                };
            }
            before.copy_from_slice(drag.q());
        }
    }
}

/// A ball joint that a tiny bound locks rotates again after the bound grows.
#[test]
fn ball_rotates_again_after_bound_grows() {
    let (model, hand) = shoulder();
    let mut builder = Problem::builder(&model);
    let goal = builder.add(Point::new(hand, [1.0, 0.0, 0.0]));
    let drag = Drag::new(builder.build().unwrap(), &model.neutral()).unwrap();
    let mut drag = drag.with_max_move(1e-13).unwrap();
    let aside = [0.8_f64.cos(), 0.8_f64.sin(), 0.0];
    drag.target_mut(goal).unwrap().set_target(aside);
    assert_eq!(drag.advance().q, model.neutral());
    let mut drag = drag.with_max_move(0.3).unwrap();
    for turned in [0.3, 0.6, 0.8] {
        drag.advance();
        let mut v = [0.0; 3];
        model
            .difference(&model.neutral(), drag.q(), &mut v)
            .unwrap();
        assert!((v[2] - turned).abs() < 1e-6, "{v:?}");
    }
    assert!(drag.solution().reached);
}

#[test]
fn locked_ball_joint_keeps_its_rotation() {
    let figure = Figure::new(1, 6);
    let model = &figure.model;
    let q = model.random_configuration(5);
    let ball = figure
        .parts
        .iter()
        .find(|part| matches!(part.kind, Kind::Ball(_)))
        .unwrap();
    let at = model.coordinate(ball.id).unwrap();
    let held = [q[at], q[at + 1], q[at + 2], q[at + 3]];
    let map = ParameterMap::builder(model)
        .with_locked_ball(ball.id, held)
        .build()
        .unwrap();
    assert_eq!(map.variables(), ParameterMap::free(model).variables() - 3);
    let mut builder = Problem::builder(model);
    builder.parameters(map);
    let last = *figure.frames.last().unwrap();
    builder.add(Point::new(last, [0.3, 0.2, 0.1]));
    let solution = Solver::default()
        .solve_once(&builder.build().unwrap(), &q)
        .unwrap();
    for (actual, held) in solution.q[at..].iter().zip(held) {
        assert!((actual - held).abs() < 1e-15);
    }
}

#[test]
fn half_turn_swing_in_narrow_cone_is_stable() {
    // An oblique axis, so that rounding blurs the direction of the swing.
    let axis = nalgebra::Vector3::new(1.0, 2.0, 3.0).normalize();
    let about = axis.cross(&nalgebra::Vector3::x()).normalize();
    let (along, up) = (support::vector(axis), support::vector(about));
    for narrow in [0.3, 1.0, PI] {
        let mut builder = Model::builder("arm");
        let limits = BallLimits::elliptic(up, [PI, narrow], Limits::new(-0.4, 0.5));
        let at = Placement::identity();
        let shoulder = builder.ball("shoulder", None, at, along, Some(limits));
        let hand = builder.frame("hand", Some(shoulder), Placement::translation(along));
        let model = builder.build().unwrap();
        let mut tasks = Problem::builder(&model);
        // Slightly more than half a turn, approached from one side.
        let target = axis * 3.3_f64.cos() + about.cross(&axis) * 3.3_f64.sin();
        tasks.add(Point::new(hand, target));
        let problem = tasks.build().unwrap();
        let start = [1.0, about.x, about.y, about.z];
        let once = Solver::default().with_restarts(Restarts::none());
        let solution = once.solve_once(&problem, &start).unwrap();
        let error = solution.position_error().unwrap();
        assert!((error - 2.0 * f64::sin(0.5 * (3.3 - PI))).abs() < 1e-6);
        assert!(model.is_within_limits(&solution.q), "{:?}", solution.q);
        let again = once.solve_once(&problem, &solution.q).unwrap();
        let mut moved = [0.0; 3];
        model.difference(&solution.q, &again.q, &mut moved).unwrap();
        assert!(moved.iter().all(|v| v.abs() < 1e-6), "moved by {moved:?}");
    }
}
