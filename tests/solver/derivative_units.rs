//! Promise: the existence and the value of a solution's derivative do not depend on the unit of length.

use kinopt::Problem;
use kinopt::ik::{DerivativeWorkspace, Differentiability, NoDerivative, SolutionDerivative};
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{FrameId, Model};
use kinopt::task::{Point, Posture};
use support::planar_arm;

/// Planar chain of `links` links of equal length.
fn chain_of(links: usize, length: f64) -> (Model, FrameId) {
    let model = planar_arm(&vec![length; links], Some((-2.0, 2.0)));
    let tip = model.frame("tip").unwrap();
    (model, tip)
}

/// Point task at the present position of the tip, added `times` times.
fn problem_of(model: &Model, tip: FrameId, q: &[f64], times: usize) -> Problem {
    let mut kinematics = ForwardKinematics::new(model);
    let target = kinematics.place(q).unwrap()[tip.index()].translation;
    let mut tasks = Problem::builder(model);
    for _ in 0..times {
        tasks.add(Point::new(tip, target));
    }
    tasks.build().unwrap()
}

#[test]
fn nearly_stretched_arm_has_a_derivative() {
    let derivative_at = |q: &[f64; 2], length: f64| {
        let (model, tip) = chain_of(2, length);
        let problem = problem_of(&model, tip, q, 1);
        let mut workspace = DerivativeWorkspace::default();
        let mut derivative = SolutionDerivative::new(&problem, q, &mut workspace).unwrap();
        let by_target = derivative.by_target(0).unwrap() * length;
        (derivative.differentiability().clone(), by_target)
    };
    let (nearly, fully) = ([0.3, 1e-4], [0.3, 0.0]);
    let (_, expected) = derivative_at(&nearly, 1.0);
    for length in [1e-4, 1e-2, 1.0, 1e3] {
        let (differentiability, by_target) = derivative_at(&nearly, length);
        assert_eq!(differentiability, Differentiability::Unique, "{length}");
        let deviation = (by_target - &expected).amax() / expected.amax();
        assert!(deviation < 1e-9, "{length}: {deviation:e}");
        let singular = NoDerivative::Singular { directions: 1 };
        let (differentiability, _) = derivative_at(&fully, length);
        assert_eq!(
            differentiability,
            Differentiability::DoesNotExist(singular),
            "{length}"
        );
    }
}

#[test]
fn duplicate_tasks_count_once_in_any_unit() {
    let q = [0.3, 0.5, -0.4, 0.9];
    for length in [1e-3, 1.0, 1e3, 1e5] {
        let (model, tip) = chain_of(4, length);
        let problem = problem_of(&model, tip, &q, 2);
        let mut workspace = DerivativeWorkspace::default();
        let derivative = SolutionDerivative::new(&problem, &q, &mut workspace).unwrap();
        let many = Differentiability::ShortestOfMany { directions: 2 };
        assert_eq!(*derivative.differentiability(), many, "{length}");
    }
}

/// An arm stretched towards a target out of reach rotates in its first joint only, by the change of the target's
/// direction.
#[test]
fn unreachable_target_derivative_in_any_unit() {
    for length in [1e-6, 1e-3, 1.0, 1e3] {
        let (model, tip) = chain_of(3, length);
        let (angle, target_distance) = (0.4_f64, 5.0 * length);
        let mut tasks = Problem::builder(&model);
        let target = [
            target_distance * angle.cos(),
            target_distance * angle.sin(),
            0.0,
        ];
        tasks.add(Point::new(tip, target));
        let problem = tasks.build().unwrap();
        let mut workspace = DerivativeWorkspace::default();
        let q = [angle, 0.0, 0.0];
        let mut derivative = SolutionDerivative::new(&problem, &q, &mut workspace).unwrap();
        assert_eq!(
            *derivative.differentiability(),
            Differentiability::Unique,
            "{length}"
        );
        let by_target = derivative.by_target(0).unwrap() * target_distance;
        let across = [-angle.sin(), angle.cos()];
        for (joint, expected) in [1.0, 0.0, 0.0].into_iter().enumerate() {
            let turned = (0..2).map(|k| by_target[(joint, k)] * across[k]);
            let off = turned.sum::<f64>() - expected;
            assert!(off.abs() < 1e-6, "{length}, joint {joint}: {off:e}");
        }
    }
}

/// With a posture in the null space, duplicated targets give the derivative of a single one.
#[test]
fn soft_task_derivative_in_any_unit() {
    let q = [0.3, 0.5, -0.4, 0.9];
    let derivative_in = |length: f64, times: usize| {
        let (model, tip) = chain_of(4, length);
        let at = ForwardKinematics::new(&model).place(&q).unwrap()[tip.index()].translation;
        let mut tasks = Problem::builder(&model);
        for _ in 0..times {
            tasks.add(Point::new(tip, at));
        }
        tasks.add(Posture::new(&model, &q));
        let problem = tasks.build().unwrap();
        let mut workspace = DerivativeWorkspace::default();
        let mut derivative = SolutionDerivative::new(&problem, &q, &mut workspace).unwrap();
        assert_eq!(
            *derivative.differentiability(),
            Differentiability::Unique,
            "{length}"
        );
        // Change of the posture.
        derivative.by_target(times).unwrap()
    };
    let expected = derivative_in(1.0, 1);
    for length in [1e-6, 1.0, 1e3] {
        for times in [1, 2] {
            let deviation = (derivative_in(length, times) - &expected).amax();
            assert!(deviation < 1e-6, "{length}, {times} times: {deviation:e}");
        }
    }
}
