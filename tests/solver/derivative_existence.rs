//! Promise: the derivative of a solution that is not a smooth function of its input reports its absence and the reason.

use kinopt::ik::{
    DerivativeWorkspace, Differentiability, NoDerivative, SolutionDerivative, SolveError,
};
use kinopt::kinematics::frame_jacobian;
use kinopt::model::{BallLimits, FrameId, Limits, Model};
use kinopt::problem::ParameterVector;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{Bounded, Gaze, Plane, Point, Posture};
use kinopt::{Problem, Solver};

/// Planar chain of `links` links of 1 m.
fn chain(links: usize, limits: Limits) -> (Model, FrameId) {
    let mut builder = Model::builder("chain");
    let z = Vector3::new(0.0, 0.0, 1.0);
    let link = Placement::translation([1.0, 0.0, 0.0].into());
    let mut joint = None;
    for k in 0..links {
        let at = if k == 0 { Placement::identity() } else { link };
        joint = Some(builder.revolute(format!("joint {k}"), joint, at, z, limits));
    }
    let tip = builder.frame("tip", joint, link);
    (builder.build().unwrap(), tip)
}

fn tip_of(model: &Model, q: &[f64]) -> Vector3<f64> {
    let mut kinematics = kinopt::kinematics::ForwardKinematics::new(model);
    kinematics.place(q).unwrap()[0].translation
}

fn differentiability(problem: &Problem, q: &[f64]) -> Differentiability {
    let mut workspace = DerivativeWorkspace::default();
    let derivative = SolutionDerivative::new(problem, q, &mut workspace).unwrap();
    derivative.differentiability().clone()
}

#[test]
fn redundant_solution_uses_the_pseudoinverse() {
    let (model, tip) = chain(4, Limits::new(-2.0, 2.0));
    let q = [0.3, 0.5, -0.4, 0.9];
    let mut tasks = Problem::builder(&model);
    tasks.add(Point::new(tip, tip_of(&model, &q)));
    let problem = tasks.build().unwrap();
    let mut workspace = DerivativeWorkspace::default();
    let mut derivative = SolutionDerivative::new(&problem, &q, &mut workspace).unwrap();
    let many = Differentiability::ShortestOfMany { directions: 2 };
    assert_eq!(*derivative.differentiability(), many);
    let jacobian = frame_jacobian(&model, tip, &q).unwrap();
    let jacobian = jacobian.rows(0, 3).into_owned();
    let inverse = jacobian.pseudo_inverse(1e-9).unwrap();
    assert!((derivative.by_target(0).unwrap() - inverse).amax() < 1e-12);
}

/// Velocities of mimic joints count in the norm: the minimum-norm solution is that of all joints.
#[test]
fn minimum_norm_includes_mimic_joints() {
    use kinopt::model::ParameterMap;
    let (model, tip) = chain(4, Limits::new(-2.0, 2.0));
    let ids = model.moving_joints().to_vec();
    let map = ParameterMap::builder(&model).with_coupled(ids[2], ids[0], -1.5, 0.2);
    let q = [0.3, 0.5, 0.2 - 1.5 * 0.3, 0.9];
    let mut tasks = Problem::builder(&model);
    tasks.parameters(map.build().unwrap());
    tasks.add(Point::new(tip, tip_of(&model, &q)));
    let problem = tasks.build().unwrap();
    let mut workspace = DerivativeWorkspace::default();
    let mut derivative = SolutionDerivative::new(&problem, &q, &mut workspace).unwrap();
    let many = Differentiability::ShortestOfMany { directions: 1 };
    assert_eq!(*derivative.differentiability(), many);
    // v = E y with orthonormal columns of E: the first and third joint move together.
    let length = (1.0_f64 + 1.5 * 1.5).sqrt();
    let mut together = nalgebra::DMatrix::zeros(4, 3);
    (together[(0, 0)], together[(2, 0)]) = (1.0 / length, -1.5 / length);
    (together[(1, 1)], together[(3, 2)]) = (1.0, 1.0);
    let jacobian = frame_jacobian(&model, tip, &q).unwrap();
    let jacobian = jacobian.rows(0, 3).into_owned() * &together;
    let expected = &together * jacobian.pseudo_inverse(1e-9).unwrap();
    assert!((derivative.by_target(0).unwrap() - expected).amax() < 1e-12);
}

#[test]
fn joints_on_limits_stay_if_others_suffice() {
    let (model, tip) = chain(4, Limits::new(-2.0, 2.0));
    let q = [0.3, 2.0, -0.4, 0.9];
    let mut tasks = Problem::builder(&model);
    tasks.add(Point::new(tip, tip_of(&model, &q)));
    let problem = tasks.build().unwrap();
    let mut workspace = DerivativeWorkspace::default();
    let mut derivative = SolutionDerivative::new(&problem, &q, &mut workspace).unwrap();
    let many = Differentiability::ShortestOfMany { directions: 2 };
    assert_eq!(*derivative.differentiability(), many);
    let by_target = derivative.by_target(0).unwrap();
    assert!(by_target.row(1).amax() == 0.0);
    let jacobian = frame_jacobian(&model, tip, &q).unwrap();
    let moved = jacobian.rows(0, 2) * by_target.columns(0, 2);
    assert!((moved - nalgebra::Matrix2::identity()).amax() < 1e-12);
}

#[test]
fn one_sided_limit_is_named() {
    let (model, tip) = chain(2, Limits::new(-2.0, 1.2));
    let q = [0.3, 1.2];
    let mut tasks = Problem::builder(&model);
    tasks.add(Point::new(tip, tip_of(&model, &q)));
    let reported = differentiability(&tasks.build().unwrap(), &q);
    let on_limit = NoDerivative::OnLimit {
        joint: "joint 1".into(),
    };
    assert_eq!(reported, Differentiability::DoesNotExist(on_limit));
    assert!(reported.to_string().contains("`joint 1`"), "{reported}");
}

/// A posture exactly at a limit has a one-sided derivative. A posture beyond it presses the joint against the limit.
#[test]
fn posture_exactly_at_a_limit_is_named() {
    let (model, _) = chain(2, Limits::new(-2.0, 1.2));
    for (reference, is_pressed) in [(1.2, false), (1.3, true)] {
        let mut tasks = Problem::builder(&model);
        tasks.add(Posture::new(&model, &[0.3, reference]));
        let reported = differentiability(&tasks.build().unwrap(), &[0.3, 1.2]);
        let on_limit = NoDerivative::OnLimit {
            joint: "joint 1".into(),
        };
        match is_pressed {
            true => assert_eq!(reported, Differentiability::Unique),
            false => assert_eq!(reported, Differentiability::DoesNotExist(on_limit)),
        }
    }
}

#[test]
fn stretched_arm_at_target_has_no_derivative() {
    let (model, tip) = chain(2, Limits::new(-2.0, 2.0));
    let mut tasks = Problem::builder(&model);
    tasks.add(Point::new(tip, [2.0, 0.0, 0.0]));
    let reported = differentiability(&tasks.build().unwrap(), &[0.0, 0.0]);
    let singular = NoDerivative::Singular { directions: 1 };
    assert_eq!(reported, Differentiability::DoesNotExist(singular));
}

#[test]
fn arm_stretched_towards_target_has_a_derivative() {
    let (model, tip) = chain(2, Limits::new(-2.0, 2.0));
    let mut tasks = Problem::builder(&model);
    tasks.add(Point::new(tip, [3.0, 0.0, 0.0]));
    let problem = tasks.build().unwrap();
    let mut workspace = DerivativeWorkspace::default();
    let mut derivative = SolutionDerivative::new(&problem, &[0.0, 0.0], &mut workspace).unwrap();
    assert!(derivative.differentiability().is_unique());
    // The arm points at the target: the angle of (3, y) is y/3.
    let by_target = derivative.by_target(0).unwrap();
    assert!((by_target[(0, 1)] - 1.0 / 3.0).abs() < 1e-8, "{by_target}");
    assert!(by_target[(1, 1)].abs() < 1e-8, "{by_target}");
}

#[test]
fn equidistant_target_has_no_derivative() {
    // The target is at the first joint: every direction is equally near.
    let (model, tip) = chain(1, Limits::new(-2.0, 2.0));
    let mut tasks = Problem::builder(&model);
    tasks.add(Point::new(tip, [0.0, 0.0, 0.0]));
    let reported = differentiability(&tasks.build().unwrap(), &[0.3]);
    let singular = NoDerivative::Singular { directions: 1 };
    assert_eq!(reported, Differentiability::DoesNotExist(singular));
}

/// The same next to a joint without influence, in either order.
#[test]
fn equidistant_target_next_to_a_free_joint() {
    let at = Placement::identity();
    let z = Vector3::UNITS[2];
    let limits = Limits::new(-2.0, 2.0);
    for idle_first in [false, true] {
        let mut builder = Model::builder("two arms");
        let (first, second) = match idle_first {
            true => ("idle", "asked"),
            false => ("asked", "idle"),
        };
        let joints = [first, second].map(|name| builder.revolute(name, None, at, z, limits));
        let link = Placement::translation([1.0, 0.0, 0.0].into());
        let tip = builder.frame("tip", Some(joints[usize::from(idle_first)]), link);
        let model = builder.build().unwrap();
        let mut tasks = Problem::builder(&model);
        tasks.add(Point::new(tip, [0.0, 0.0, 0.0]));
        let reported = differentiability(&tasks.build().unwrap(), &[0.3, 0.4]);
        let singular = NoDerivative::Singular { directions: 2 };
        assert_eq!(
            reported,
            Differentiability::DoesNotExist(singular),
            "{idle_first}"
        );
    }
}

#[test]
fn non_stationary_configuration_is_reported() {
    let (model, tip) = chain(2, Limits::new(-2.0, 2.0));
    let mut tasks = Problem::builder(&model);
    tasks.add(Point::new(tip, [3.0, 0.0, 0.0]));
    let reported = differentiability(&tasks.build().unwrap(), &[0.5, 0.3]);
    assert_eq!(reported.name(), "not_stationary", "{reported}");
}

/// Task that keeps the tip of two links above 1.5 m, and is active.
fn on_an_edge(pulled: bool) -> (Model, Problem) {
    let (model, tip) = chain(2, Limits::new(-2.0, 2.0));
    let mut tasks = Problem::builder(&model);
    let height = Plane::new(tip, [0.0; 3], [0.0, 1.0, 0.0]);
    tasks.add(Bounded::at_least(height, 1.5));
    if pulled {
        tasks.add(Posture::new(&model, &[0.2, 0.4]));
    }
    let problem = tasks.build().unwrap();
    (model, problem)
}

#[test]
fn inactive_inequality_edge_has_no_derivative() {
    let (model, problem) = on_an_edge(false);
    let start = [0.2, 0.4];
    let solution = Solver::default().solve_once(&problem, &start).unwrap();
    assert!(solution.reached);
    let reported = differentiability(&problem, &solution.q);
    let height = tip_of(&model, &solution.q).y;
    // Rounding decides whether it ended on the edge or inside.
    match height < 1.5 {
        true => assert_eq!(reported.name(), "at_kink", "{reported}"),
        false => assert_eq!(reported.name(), "shortest_of_many", "{reported}"),
    }

    let (model, problem) = on_an_edge(true);
    let solution = Solver::default().solve_once(&problem, &start).unwrap();
    assert!(solution.reached);
    let mut workspace = DerivativeWorkspace::default();
    let mut derivative = SolutionDerivative::new(&problem, &solution.q, &mut workspace).unwrap();
    assert!(
        derivative.differentiability().is_unique(),
        "{}",
        derivative.differentiability()
    );
    // The floor rises by 1 m/s, and the tip with it.
    let mut rates = ParameterVector::new(&problem);
    rates.target_mut(0)[1] = 1.0;
    let mut v = [0.0; 2];
    derivative.velocity(&rates, &mut v).unwrap();
    let [sin, sum] = [solution.q[0], solution.q[0] + solution.q[1]];
    let rise = v[0] * (sin.cos() + sum.cos()) + v[1] * sum.cos();
    assert!((rise - 1.0).abs() < 1e-9, "{rise}");
    let _ = model;
}

/// A direction of twice the length rotates half as far.
#[test]
fn gaze_on_its_cone_edge_rotates_with_the_cone() {
    let (model, tip) = chain(1, Limits::new(-2.0, 2.0));
    for length in [1.0, 2.0, 0.2] {
        let (along, axis) = ([length, 0.0, 0.0], [1.0, 0.0, 0.0]);
        let mut tasks = Problem::builder(&model);
        tasks.add(Gaze::along(tip, axis, along, 0.3));
        tasks.add(Posture::new(&model, &[1.0]));
        let problem = tasks.build().unwrap();
        let solution = Solver::default().solve_once(&problem, &[1.0]).unwrap();
        let mut workspace = DerivativeWorkspace::default();
        let mut derivative =
            SolutionDerivative::new(&problem, &solution.q, &mut workspace).unwrap();
        assert!(
            derivative.differentiability().is_unique(),
            "{}",
            derivative.differentiability()
        );
        let by_target = derivative.by_target(0).unwrap();
        let turned = by_target[(0, 1)] * length;
        assert!((turned - 1.0).abs() < 1e-9, "{by_target}");
    }
}

#[test]
fn foreign_input_is_rejected() {
    let (model, tip) = chain(2, Limits::new(-2.0, 2.0));
    let mut tasks = Problem::builder(&model);
    tasks.add(Point::new(tip, [1.0, 1.0, 0.0]));
    let problem = tasks.build().unwrap();
    let (other, _) = chain(3, Limits::new(-2.0, 2.0));
    let mut workspace = DerivativeWorkspace::default();
    let short = SolutionDerivative::new(&problem, &[0.0], &mut workspace);
    assert!(matches!(short.unwrap_err(), SolveError::StartLength { .. }));
    let invalid = SolutionDerivative::new(&problem, &[0.0, f64::NAN], &mut workspace);
    assert!(matches!(
        invalid.unwrap_err(),
        SolveError::StartNotFinite { .. }
    ));

    let mut workspace = DerivativeWorkspace::default();
    let q = [0.0, std::f64::consts::FRAC_PI_2];
    let mut derivative = SolutionDerivative::new(&problem, &q, &mut workspace).unwrap();
    let mut parameters = derivative.parameters();
    let length = derivative.gradient(&[1.0], &mut parameters).unwrap_err();
    let (given, expected) = (1, 2);
    assert_eq!(length, SolveError::VelocityLength { given, expected });
    let mut foreign = parameters.clone().with_joint_origins(2);
    let refused = derivative.gradient(&[1.0, 0.0], &mut foreign).unwrap_err();
    assert_eq!(refused, SolveError::ForeignParameters);
    assert!(derivative.by_target(1).is_err());
    assert!(derivative.with_joint_origins(&other).is_err());
}

/// The ball joint would leave its limit in one direction and stay in the other.
#[test]
fn ball_at_its_total_angle_is_named() {
    let mut builder = Model::builder("shoulder");
    let x = Vector3::new(1.0, 0.0, 0.0);
    let limits = BallLimits::within_angle(0.5);
    let shoulder = builder.ball("shoulder", None, Placement::identity(), x, Some(limits));
    let hand = builder.frame("hand", Some(shoulder), Placement::translation(x));
    let model = builder.build().unwrap();
    for (turned, expected) in [(0.3_f64, "shortest_of_many"), (0.5, "on_limit")] {
        let mut tasks = Problem::builder(&model);
        tasks.add(Point::new(hand, [turned.cos(), turned.sin(), 0.0]));
        let half = 0.5 * turned;
        let reported =
            differentiability(&tasks.build().unwrap(), &[half.cos(), 0.0, 0.0, half.sin()]);
        assert_eq!(reported.name(), expected, "{reported}");
        if let Differentiability::DoesNotExist(NoDerivative::OnLimit { joint }) = reported {
            assert_eq!(joint, "shoulder");
        }
    }
}

/// A twist without range is no limit that the solution could leave. The derivative exists, without twist.
#[test]
fn twist_without_range_is_no_active_limit() {
    let [x, y, z] = Vector3::UNITS;
    let mut builder = Model::builder("arm");
    let limits = BallLimits::cone(1.5, Limits::new(0.2, 0.2));
    let still = Placement::identity();
    let shoulder = builder.ball("shoulder", None, still, x, Some(limits));
    let elbow = Placement::translation(x + y * 0.2);
    let turns = Limits::new(-2.0, 2.0);
    let elbow = builder.revolute("elbow", Some(shoulder), elbow, z, turns);
    let tip = builder.frame("tip", Some(elbow), Placement::translation(x));
    let model = builder.build().unwrap();
    let mut q = model.neutral();
    model
        .integrate(&q.clone(), &[0.0, 0.2, -0.3, 0.9], &mut q)
        .unwrap();
    // Closest configuration within the limits, and its tip.
    let mut tasks = Problem::builder(&model);
    tasks.add(Point::new(tip, tip_of(&model, &q)));
    let solution = Solver::default().solve_once(&tasks.build().unwrap(), &q);
    let q = solution.unwrap().q;
    let mut tasks = Problem::builder(&model);
    tasks.add(Point::new(tip, tip_of(&model, &q)));
    let problem = tasks.build().unwrap();
    let mut workspace = DerivativeWorkspace::default();
    let mut derivative = SolutionDerivative::new(&problem, &q, &mut workspace).unwrap();
    assert_eq!(*derivative.differentiability(), Differentiability::Unique);
    let by_target = derivative.by_target(0).unwrap();
    let jacobian = frame_jacobian(&model, tip, &q).unwrap();
    let moved = jacobian.rows(0, 3) * by_target;
    assert!((moved - nalgebra::Matrix3::identity()).amax() < 1e-9);
}

/// The weight of a task without gradient has no effect, and the weights of later tasks keep their derivatives.
#[test]
fn satisfied_task_keeps_other_weight_derivatives() {
    let mut builder = Model::builder("two arms");
    let (z, turns) = (Vector3::UNITS[2], Limits::new(-2.0, 2.0));
    let (still, link) = (
        Placement::identity(),
        Placement::translation(Vector3::UNITS[0]),
    );
    let mut tips = Vec::new();
    for side in ["left", "right"] {
        let shoulder = builder.revolute(format!("{side} shoulder"), None, still, z, turns);
        let elbow = builder.revolute(format!("{side} elbow"), Some(shoulder), link, z, turns);
        tips.push(builder.frame(side, Some(elbow), link));
    }
    let model = builder.build().unwrap();
    let start = [0.3, 0.5, -0.4, 0.9];
    let mut tasks = Problem::builder(&model);
    // The left hand is exactly at its target.
    tasks.add(Point::new(tips[0], tip_of(&model, &start)));
    tasks.add(Point::new(tips[1], [1.0, 1.0, 0.0]));
    tasks.add(Plane::new(tips[1], [1.5, 0.0, 0.0], [1.0, 0.0, 0.0]));
    let problem = tasks.build().unwrap();
    let solution = Solver::default().solve_once(&problem, &start).unwrap();
    let mut workspace = DerivativeWorkspace::default();
    let mut derivative = SolutionDerivative::new(&problem, &solution.q, &mut workspace).unwrap();
    assert_eq!(*derivative.differentiability(), Differentiability::Unique);
    // ⟨slope, dq/dp · rate⟩ = ⟨dq/dpᵀ · slope, rate⟩, with the slope of the right arm only.
    let slope = [0.0, 0.0, 0.7, -0.2];
    let mut gradient = ParameterVector::new(&problem);
    derivative.gradient(&slope, &mut gradient).unwrap();
    let mut largest = 0.0_f64;
    for weight in 0..gradient.weights().len() {
        let mut rates = ParameterVector::new(&problem);
        rates.weights_mut()[weight] = 1.0;
        let mut velocity = [0.0; 4];
        derivative.velocity(&rates, &mut velocity).unwrap();
        let forward: f64 = slope.iter().zip(velocity).map(|(s, v)| s * v).sum();
        let deviation = (forward - gradient.weights()[weight]).abs();
        assert!(
            deviation < 1e-9,
            "weight {weight}: {forward} {:?}",
            gradient.weights()
        );
        largest = largest.max(forward.abs());
    }
    assert!(largest > 1e-3, "no weight matters");
}

/// A limit exactly at the balance of opposite gradients has no force. Their sum is nonzero by rounding only.
#[test]
fn limit_at_the_balance_point_is_undecided() {
    let x = Vector3::UNITS[0];
    let at = Placement::identity();
    for (limits, value) in [
        (Limits::new(-1.0, 0.3), 0.3),
        (Limits::new(0.3, 1.0), 0.3),
        (Limits::new(-0.7, 0.7), 0.7),
        (Limits::new(-0.1, 0.9), -0.1),
    ] {
        let mut builder = Model::builder("slide");
        let slide = builder.prismatic("slide", None, at, x, limits);
        let tip = builder.frame("tip", Some(slide), at);
        let model = builder.build().unwrap();
        let mut tasks = Problem::builder(&model);
        for off in [-0.2, -0.1, 0.3] {
            tasks.add(Point::new(tip, [value + off, 0.0, 0.0]));
        }
        let reported = differentiability(&tasks.build().unwrap(), &[value]);
        let Differentiability::DoesNotExist(NoDerivative::OnLimit { joint }) = reported else {
            panic!("{limits:?}: {reported}");
        };
        assert_eq!(joint, "slide");
    }
}

/// A cleared parameter vector is zero in all parts.
#[test]
fn cleared_parameters_are_zero() {
    let (model, tip) = chain(3, Limits::new(-2.0, 2.0));
    let mut tasks = Problem::builder(&model);
    tasks.add(Point::new(tip, [1.0, 1.0, 0.0]));
    tasks.add(Posture::new(&model, &[0.1; 3]));
    let problem = tasks.build().unwrap();
    let none = ParameterVector::new(&problem).with_joint_origins(3);
    let mut changed = none.clone();
    changed.targets_mut().fill(1.0);
    changed.weights_mut().fill(2.0);
    changed.joint_origins_mut().fill(Vector3::UNITS[1]);
    assert!(changed.targets().len() == 6 && changed.weights().len() == 2 && changed != none);
    changed.clear();
    assert_eq!(changed, none);
}

/// Gradients that cancel except for rounding at a limit leave no derivative.
#[test]
fn limit_with_rounding_force_has_no_derivative() {
    for limits in [Limits::new(0.0, 1.0), Limits::new(-1.0, 0.0)] {
        let (model, tip) = chain(1, limits);
        for sign in [1.0, -1.0] {
            let mut tasks = Problem::builder(&model);
            // In floating point 0.1 + 0.2 − 0.3 is not 0.
            for height in [0.1, 0.2, -0.3] {
                tasks.add(Point::new(tip, [1.0, sign * height, 0.0]));
            }
            let problem = tasks.build().unwrap();
            let joint = "joint 0".to_owned();
            let none = Differentiability::DoesNotExist(NoDerivative::OnLimit { joint });
            assert_eq!(
                differentiability(&problem, &[0.0]),
                none,
                "{limits:?} {sign}"
            );
        }
    }
}
