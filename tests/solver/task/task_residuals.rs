//! Promise: the residual of every task equals its formula to 1e-12 of the numbers involved.

use kinopt::Problem;
use kinopt::model::{Limits, Model};
use kinopt::problem::{Evaluation, ProblemInstance};
use kinopt::solver::LeastSquares;
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{Distance, Gaze, LookAt, Point, Posture, Quantity, Residual, Smoothness, Task};
use nalgebra as na;
use support::planar_arm;
use support::random::Random;
use support::tasks::{WEIGHT, tasks_of};
use support::trees::RandomTree;

#[test]
fn residuals_equal_their_formulas() {
    for seed in 0..10 {
        let tree = RandomTree::new(seed, 12);
        let mut random = Random::new(seed);
        let q = tree.configuration(&mut random);
        for case in tasks_of(&tree, &q, &mut random) {
            let mut builder = Problem::builder(&tree.model);
            (case.add)(&mut builder);
            let problem = builder.build().unwrap();
            let mut scratch = problem.scratch();
            let mut evaluation = Evaluation::new(&problem, &mut scratch);
            let mut residual = vec![f64::NAN; problem.rows()];
            // At the configuration of the target and at another.
            for q in [q.clone(), tree.configuration(&mut random)] {
                evaluation.residual(&q, &mut residual);
                let expected = (case.expected)(&tree.frames_at(&q), &q);
                assert_eq!(residual.len(), expected.len(), "{}", case.name);
                let size = expected.iter().fold(1.0_f64, |m, v| m.max(v.abs()));
                for (ours, theirs) in residual.iter().zip(&expected) {
                    let error = (ours / WEIGHT - theirs).abs();
                    assert!(error <= 1e-12 * size, "{} {seed}: {error:e}", case.name);
                }
            }
        }
    }
}

#[test]
fn look_at_is_accurate_when_looking_away() {
    // Half a turn less δ is missing, and the result must resolve δ. (Within 1.4e-6 of half a turn every perpendicular
    // axis is equally good, and half a turn is reported.)
    let tree = RandomTree::new(5, 9);
    let q = tree.configuration(&mut Random::new(5));
    let frame_pose = tree.frames_at(&q)[7];
    let axis = na::Vector3::new(0.3, -0.5, 0.8).normalize();
    let across = axis.cross(&na::Vector3::x()).normalize();
    for delta in [0.1, 1e-3, 1e-5, 2e-6] {
        let away = -axis * f64::cos(delta) + across * f64::sin(delta);
        let watched = frame_pose.translation.vector + frame_pose.rotation * away * 2.0;
        let mut builder = Problem::builder(&tree.model);
        let look = LookAt::new(tree.frames[7], axis, watched);
        builder.add(Task::new(look).weight(Quantity::Radians, 1.0));
        let problem = builder.build().unwrap();
        let mut scratch = problem.scratch();
        let mut residual = [0.0; 3];
        Evaluation::new(&problem, &mut scratch).residual(&q, &mut residual);
        let missing = na::Vector3::from(residual).norm();
        let error = (missing - (std::f64::consts::PI - delta)).abs();
        assert!(error < 1e-12, "δ = {delta:e}: off by {error:e} rad");
    }
}

#[test]
fn target_at_the_frames_origin_is_looked_at() {
    let model = planar_arm(&[1.0], None);
    let tip = model.frame("tip").unwrap();
    let (axis, target) = ([0.0, -2.0, 0.0], [0.5, 2.0, 7.0]);
    let at_target = [Placement::translation(Vector3::from(target))];
    let mut off = [f64::NAN; 3];
    LookAt::new(tip, axis, target).evaluate(&at_target, &[], &mut off);
    assert_eq!(off, [0.0; 3]);
    Gaze::at(tip, axis, target, 0.1).evaluate(&at_target, &[], &mut off[..1]);
    assert_eq!(off[0], 0.0);
}

/// Residual of the only task at a configuration.
fn residual<'a>(question: impl Into<ProblemInstance<'a>>, q: &[f64]) -> Vec<f64> {
    let question = question.into();
    let mut residual = vec![f64::NAN; question.rows()];
    let mut scratch = question.scratch();
    Evaluation::new(question, &mut scratch).residual(q, &mut residual);
    residual
}

#[test]
fn references_are_replaced_as_a_whole() {
    let model = planar_arm(&[1.0; 3], None);
    let (before, reference) = ([0.0; 3], [1.0, 2.0, -3.0]);
    let posture = Task::new(Posture::new(&model, &before)).weight(Quantity::JointUnits, 1.0);
    let mut builder = Problem::builder(&model);
    let task = builder.add(posture);
    let problem = builder.build().unwrap();
    let mut targets = problem.targets();
    targets
        .get_mut(task)
        .unwrap()
        .set_reference(&reference)
        .unwrap();
    let question = problem.with_targets(&targets).unwrap();
    assert_eq!(residual(question, &before), [-1.0, -2.0, 3.0]);

    let smooth = Task::new(Smoothness::new(&model, &before, 0.5));
    let mut builder = Problem::builder(&model);
    let task = builder.add(smooth.weight(Quantity::JointUnitsPerSecond, 1.0));
    let problem = builder.build().unwrap();
    let mut targets = problem.targets();
    targets
        .get_mut(task)
        .unwrap()
        .set_previous(&reference)
        .unwrap();
    let question = problem.with_targets(&targets).unwrap();
    assert_eq!(residual(question, &before), [-2.0, -4.0, 6.0]);
}

/// Coinciding frames have distance 0 and a derivative that separates them.
#[test]
fn coinciding_frames_have_zero_distance() {
    let mut two = Model::builder("two");
    let (at, along_x) = (Placement::identity(), Vector3::new(1.0, 0.0, 0.0));
    let slide = two.prismatic("slide", None, at, along_x, Limits::new(-2.0, 2.0));
    let (still, moved) = (
        two.frame("still", None, at),
        two.frame("moved", Some(slide), at),
    );
    let two = two.build().unwrap();
    let mut builder = Problem::builder(&two);
    builder.add(Task::new(Distance::new(moved, still, 0.4)).weight(Quantity::Metres, 1.0));
    let problem = builder.build().unwrap();
    assert_eq!(residual(&problem, &[0.0]), [-0.4]);
    let mut scratch = problem.scratch();
    let mut jacobian = na::DMatrix::zeros(1, 1);
    Evaluation::new(&problem, &mut scratch).jacobian(&[0.0], &mut jacobian);
    assert_eq!(jacobian[(0, 0)], 1.0);
}

#[test]
fn weight_factors_multiply() {
    let model = planar_arm(&[1.0], None);
    let tip = model.frame("tip").unwrap();
    let mut builder = Problem::builder(&model);
    let point = Task::new(Point::new(tip, [0.5, 0.0, 0.0])).weight(Quantity::Metres, 0.5);
    builder.add(point.scale(2.0).scale(3.0));
    let problem = builder.build().unwrap();
    assert_eq!(residual(&problem, &[0.0]), [1.5, 0.0, 0.0]);
}

/// The last of repeated weights and tolerances applies.
#[test]
fn last_weight_and_tolerance_apply() {
    let model = planar_arm(&[1.0], None);
    let tip = model.frame("tip").unwrap();
    let mut builder = Problem::builder(&model);
    let point = Task::new(Point::new(tip, [0.0, 0.0, 0.0]));
    let point = point
        .weight(Quantity::Metres, 5.0)
        .tolerance(Quantity::Metres, 9.0);
    builder.add(
        point
            .weight(Quantity::Metres, 3.0)
            .tolerance(Quantity::Metres, 0.5),
    );
    let problem = builder.build().unwrap();
    let mut scratch = problem.scratch();
    let mut residual = [0.0; 3];
    Evaluation::new(&problem, &mut scratch).residual(&[0.0], &mut residual);
    assert_eq!(residual, [3.0, 0.0, 0.0]);
    assert!(
        !problem.is_reached(&residual).unwrap() && problem.is_reached(&[1.4, 0.0, 0.0]).unwrap()
    );
}

/// The error of a gaze outside its cone is the angle beyond, for cones of any width.
#[test]
fn gaze_error_is_the_angle_beyond_its_cone() {
    let model = planar_arm(&[1.0], None);
    let tip = model.frame("tip").unwrap();
    for half_angle in [1e-3, 0.05, 0.2, 0.7, 1.5] {
        for beyond in [-0.6 * half_angle, -1e-4, 1e-5, 0.02, 0.5, 1.2] {
            let angle: f64 = half_angle + beyond;
            let axis = [1.0, 0.0, 0.0];
            let along = Gaze::along(tip, axis, [angle.cos(), angle.sin(), 0.0], half_angle);
            let at = Gaze::at(
                tip,
                axis,
                [2.0 * angle.cos(), 0.0, 2.0 * angle.sin()],
                half_angle,
            );
            for gaze in [along, at] {
                let mut off = [f64::NAN];
                gaze.evaluate(&[Placement::identity()], &[], &mut off);
                let expected = beyond.max(0.0);
                assert!(
                    (off[0] - expected).abs() < 1e-12,
                    "{half_angle} {beyond}: {off:?}"
                );
            }
        }
    }
}
