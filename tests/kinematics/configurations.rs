//! Promise: configurations with free and ball joints integrate, differ and interpolate on their manifold. Frame
//! placements equal nalgebra's isometries, and the Jacobian is the derivative along velocities.

use kinopt::kinematics::{ForwardKinematics, KinematicsError, frame_jacobian};
use kinopt::model::{BallLimits, Limits, Model, ModelError};
use kinopt::spatial::{Placement, Vector3};
use nalgebra as na;
use support::figures::{Figure, unit};
use support::random::Random;

fn velocity(model: &Model, random: &mut Random, size: f64) -> Vec<f64> {
    let draw = |_| random.within(-size, size);
    (0..model.degrees_of_freedom()).map(draw).collect()
}

/// Largest difference of two configurations; q and −q are the same rotation.
fn largest_difference(model: &Model, a: &[f64], b: &[f64]) -> f64 {
    let mut v = vec![0.0; model.degrees_of_freedom()];
    model.difference(a, b, &mut v).unwrap();
    v.iter().fold(0.0, |largest, v| largest.max(v.abs()))
}

#[test]
fn integrate_and_difference_are_inverse() {
    for seed in 0..20 {
        let Figure { model, .. } = Figure::new(seed, 9);
        let random = &mut Random::new(seed);
        let (a, b) = (
            model.random_configuration(seed),
            model.random_configuration(seed + 100),
        );
        let (n, dof) = (model.configuration_len(), model.degrees_of_freedom());
        assert!(n > dof, "a quaternion has more numbers than ways to turn");
        let (mut q, mut v) = (vec![0.0; n], vec![0.0; dof]);

        model.difference(&a, &b, &mut v).unwrap();
        model.integrate(&a, &v, &mut q).unwrap();
        assert!(
            largest_difference(&model, &q, &b) < 1e-12,
            "a + (b - a) is b"
        );

        let step = velocity(&model, random, 1.5);
        model.integrate(&a, &step, &mut q).unwrap();
        model.difference(&a, &q, &mut v).unwrap();
        let deviation = step.iter().zip(&v).map(|(a, b)| (a - b).abs());
        assert!(deviation.fold(0.0, f64::max) < 1e-12, "(a + v) - a is v");

        for (share, end) in [(0.0, &a), (1.0, &b)] {
            model.interpolate(&a, &b, share, &mut q).unwrap();
            assert!(largest_difference(&model, &q, end) < 1e-12);
        }
        let mut half = vec![0.0; n];
        model.interpolate(&a, &b, 0.5, &mut half).unwrap();
        model.interpolate(&b, &a, 0.5, &mut q).unwrap();
        assert!(
            largest_difference(&model, &q, &half) < 1e-12,
            "the middle is the same from both ends"
        );

        let mut long = b.clone();
        for part in &mut long[3..7] {
            *part *= -3.0;
        }
        model.normalise(&mut long).unwrap();
        assert!((na::Vector4::from_row_slice(&long[3..7]).norm() - 1.0).abs() < 1e-15);
        assert!(largest_difference(&model, &long, &b) < 1e-12);
    }
}

#[test]
fn free_joint_moves_by_the_twist_exponential() {
    let mut builder = Model::builder("body");
    let body = builder.free("base", None, Placement::identity(), [Limits::UNBOUNDED; 3]);
    builder.frame("body", Some(body), Placement::identity());
    let model = builder.build().unwrap();
    let random = &mut Random::new(3);
    for seed in 0..20 {
        let q = model.random_configuration(seed);
        let v = velocity(&model, random, 2.0);
        let matrix = |q: &[f64]| -> na::Matrix4<f64> {
            let at = na::Translation3::new(q[0], q[1], q[2]);
            na::Isometry3::from_parts(at, unit(&q[3..])).to_homogeneous()
        };
        let [x, y, z, a, b, c] = v[..] else {
            unreachable!()
        };
        #[rustfmt::skip]
        let twist = na::Matrix4::new(
            0.0, -c, b, x,
            c, 0.0, -a, y,
            -b, a, 0.0, z,
            0.0, 0.0, 0.0, 0.0,
        );
        let mut moved = vec![0.0; 7];
        model.integrate(&q, &v, &mut moved).unwrap();
        let deviation = (matrix(&moved) - matrix(&q) * twist.exp()).amax();
        assert!(deviation < 1e-12, "{deviation:e}");
    }
}

#[test]
fn frame_placements_equal_isometries() {
    for seed in 0..20 {
        let figure = Figure::new(seed, 9);
        let q = figure.model.random_configuration(seed);
        assert!(figure.model.is_within_limits(&q));
        assert_eq!(figure.broken(&q), None);
        let mut kinematics = ForwardKinematics::of_frames(&figure.model, &figure.frames).unwrap();
        let placed = kinematics.place(&q).unwrap();
        for (ours, theirs) in placed.iter().zip(figure.frames_at(&q)) {
            let deviation = support::apart(ours, &theirs);
            assert!(deviation < 1e-13, "{deviation:e}");
        }
    }
}

#[test]
fn jacobian_is_the_derivative_along_velocities() {
    const H: f64 = 1e-6;
    for seed in 0..10 {
        let figure = Figure::new(seed, 9);
        let model = &figure.model;
        let q = model.random_configuration(seed);
        let mut q_moved = q.clone();
        for (k, &frame) in figure.frames.iter().enumerate() {
            let jacobian = frame_jacobian(model, frame, &q).unwrap();
            assert_eq!(jacobian.ncols(), model.degrees_of_freedom());
            for column in 0..model.degrees_of_freedom() {
                let mut moved_frames = |h: f64| {
                    let mut v = vec![0.0; model.degrees_of_freedom()];
                    v[column] = h;
                    model.integrate(&q, &v, &mut q_moved).unwrap();
                    figure.frames_at(&q_moved)[k]
                };
                let (ahead, behind) = (moved_frames(H), moved_frames(-H));
                let linear = (ahead.translation.vector - behind.translation.vector) / (2.0 * H);
                let turned = (ahead.rotation * behind.rotation.inverse()).into_inner();
                let skew = (turned - turned.transpose()) / 2.0;
                let angular = na::Vector3::new(skew.m32, skew.m13, skew.m21) / (2.0 * H);
                let twist = jacobian.column(column);
                let deviation = (twist.fixed_rows::<3>(0) - linear).amax();
                let deviation = deviation.max((twist.fixed_rows::<3>(3) - angular).amax());
                assert!(
                    deviation < 1e-8,
                    "seed {seed}, frame {k}, column {column}: {deviation:e}"
                );
            }
        }
    }
}

/// Ball joints among revolute joints, in any order.
#[test]
fn joints_outside_limits_are_in_model_order() {
    for order in [
        ["ball", "hinge", "neck"],
        ["hinge", "ball", "neck"],
        ["neck", "ball", "hinge"],
    ] {
        let mut builder = Model::builder("mixed");
        let (at, z) = (Placement::identity(), Vector3::UNITS[2]);
        let limits = Limits::new(-0.5, 0.5);
        for name in order {
            match name {
                "hinge" => builder.revolute(name, None, at, z, limits),
                _ => builder.ball(name, None, at, z, Some(BallLimits::cone(0.5, limits))),
            };
        }
        let model = builder.build().unwrap();
        let mut q = model.neutral();
        assert!(model.joints_outside_limits(&q).unwrap().is_empty());
        for name in order {
            let coordinate = model.coordinate(model.joint(name).unwrap()).unwrap();
            match name {
                "hinge" => q[coordinate] = 0.7,
                // Rotated by 1 rad about x.
                _ => q[coordinate..coordinate + 2].copy_from_slice(&[0.5_f64.cos(), 0.5_f64.sin()]),
            }
        }
        let beyond = model.joints_outside_limits(&q).unwrap();
        let names = beyond
            .iter()
            .map(|id| model.joints()[id.index()].name.as_str());
        assert_eq!(names.collect::<Vec<_>>(), order);
        // A quaternion that is not of unit length violates several coordinates, and its joint is listed once.
        for name in ["ball", "neck"] {
            let coordinate = model.coordinate(model.joint(name).unwrap()).unwrap();
            for number in &mut q[coordinate..coordinate + 4] {
                *number *= 3.0;
            }
        }
        assert_eq!(model.joints_outside_limits(&q).unwrap(), beyond);
    }
}

/// Joints and twists whose range excludes zero are at the end nearest to zero.
#[test]
fn neutral_is_the_limit_nearest_to_zero() {
    for (lower, upper, nearest) in [(-1.2, -0.4, -0.4), (0.3, 0.9, 0.3), (-0.5, 0.7, 0.0_f64)] {
        let mut builder = Model::builder("twisted");
        let (at, z) = (Placement::identity(), Vector3::UNITS[2]);
        let limits = Limits::new(lower, upper);
        builder.revolute("hinge", None, at, z, limits);
        let cone = BallLimits::cone(0.5, limits);
        let ball = builder.ball("ball", None, at, z, Some(cone));
        let model = builder.build().unwrap();
        let q = model.neutral();
        assert!(model.joints_outside_limits(&q).unwrap().is_empty());
        let hinge = model.coordinate(model.joint("hinge").unwrap()).unwrap();
        let ball = model.coordinate(ball).unwrap();
        let turn = [(0.5 * nearest).cos(), 0.0, 0.0, (0.5 * nearest).sin()];
        let deviation = q[ball..ball + 4]
            .iter()
            .zip(turn)
            .map(|(a, b)| (a - b).abs());
        assert!(deviation.fold(0.0, f64::max) < 1e-12, "{q:?}");
        assert_eq!(q[hinge], nearest);
    }
}

#[test]
fn invalid_numbers_and_quaternions_are_named() {
    let Figure { model, frames, .. } = Figure::new(0, 5);
    let q = model.neutral();
    let mut to = q.clone();
    let mut none = q.clone();
    none[3..7].fill(0.0);
    let v = vec![0.0; model.degrees_of_freedom()];
    let named = ModelError::NoRotation {
        joint: "joint 0/rotation".to_owned(),
    };
    assert_eq!(model.integrate(&none, &v, &mut to), Err(named.clone()));
    assert_eq!(model.normalise(&mut none.clone()), Err(named));
    assert!(model.integrate(&q, &v[1..], &mut to).is_err());
    let mut lost = v.clone();
    lost[2] = f64::NAN;
    assert!(model.integrate(&q, &lost, &mut to).is_err());
    assert!(model.interpolate(&q, &q, f64::NAN, &mut to).is_err());
    assert!(!model.is_within_limits(&q[1..]));
    assert!(model.joints_outside_limits(&q[1..]).is_err());
    let mut kinematics = ForwardKinematics::<f64>::of_frames(&model, &frames).unwrap();
    assert!(matches!(
        kinematics.place(&none),
        Err(KinematicsError::NoRotation { index: 3, .. })
    ));
    // Any nonzero length is enough.
    none[3] = 1e-200;
    assert!(model.integrate(&none, &v, &mut to).is_ok());
}

/// Index of the configuration, in which a ball has four numbers, not of the variables, in which it has three.
#[test]
fn non_finite_numbers_are_reported_by_index() {
    let mut builder = Model::builder("balls");
    let (z, still) = (Vector3::new(0.0, 0.0, 1.0), Placement::identity());
    let mut last = None;
    for name in ["first", "second", "third"] {
        last = Some(builder.ball(name, last, still, z, None));
    }
    builder.frame("tip", last, Placement::translation(z));
    let model = builder.build().unwrap();
    let mut kinematics = ForwardKinematics::<f64>::new(&model);
    for ball in 0..3 {
        let mut q = model.neutral();
        q[4 * ball..4 * ball + 4].fill(0.0);
        let error = kinematics.place(&q).unwrap_err();
        let expected = 4 * ball;
        assert!(
            matches!(error, KinematicsError::NoRotation { index, .. } if index == expected),
            "{error}"
        );
        q[4 * ball + 2] = f64::NAN;
        let error = kinematics.place(&q).unwrap_err();
        let expected = 4 * ball + 2;
        assert!(
            matches!(error, KinematicsError::NotFinite { index, .. } if index == expected),
            "{error}"
        );
    }
}

#[test]
fn impossible_ball_limits_are_rejected() {
    use kinopt::model::BallLimits;
    let z = Vector3::new(0.0, 0.0, 1.0);
    let free = Limits::UNBOUNDED;
    for limits in [
        BallLimits::cone(3.2, free),
        BallLimits::cone(0.0, free),
        BallLimits::cone(f64::NAN, free),
        BallLimits::cone(1.0, Limits::new(1.0, -1.0)),
        BallLimits::cone(1.0, Limits::new(-4.0, 1.0)),
        BallLimits::elliptic(z, [1.0, 0.5], free),
        BallLimits::within_angle(0.0),
        BallLimits::within_angle(-1.0),
        BallLimits::within_angle(f64::NAN),
        // A twist of at least 0.5 rad is a rotation of at least that.
        BallLimits::cone(1.0, Limits::new(0.5, 1.0)).with_angle(0.4),
        BallLimits::cone(1.0, Limits::new(-1.0, -0.5)).with_angle(0.4),
    ] {
        let mut builder = Model::builder("ball");
        builder.ball("shoulder", None, Placement::identity(), z, Some(limits));
        let error = builder.build().unwrap_err();
        assert!(matches!(&error, ModelError::BadBallLimits { joint, .. } if joint == "shoulder"));
    }
    let mut builder = Model::builder("ball");
    let limits = BallLimits::cone(1.0, Limits::new(-1.0, -0.5)).with_angle(0.6);
    builder.ball("shoulder", None, Placement::identity(), z, Some(limits));
    assert!(builder.build().is_ok());
}
