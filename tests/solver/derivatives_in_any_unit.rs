//! Promise: whether a solution has a derivative, and which, does not depend on the unit of length.
#![allow(clippy::unwrap_used)]

use kinopt::Problem;
use kinopt::ik::{DerivativeWorkspace, Existence, NoDerivative, SolutionDerivative};
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{FrameId, Model};
use kinopt::task::{Point, Posture};
use support::planar_arm;

/// So many links of a length in the plane.
fn chain_of(links: usize, length: f64) -> (Model, FrameId) {
    let model = planar_arm(&vec![length; links], Some((-2.0, 2.0)));
    let tip = model.frame("tip").unwrap();
    (model, tip)
}

/// That the tip is where it is, so often.
fn problem_of(model: &Model, tip: FrameId, q: &[f64], times: usize) -> Problem {
    let mut kinematics = ForwardKinematics::new(model);
    let there = kinematics.place(q).unwrap()[tip.index()].translation;
    let mut tasks = Problem::builder(model);
    for _ in 0..times {
        tasks.add(Point::new(tip, there));
    }
    tasks.build().unwrap()
}

#[test]
fn an_arm_nearly_stretched_has_one_in_any_unit() {
    let of = |q: &[f64; 2], length: f64| {
        let (model, tip) = chain_of(2, length);
        let problem = problem_of(&model, tip, q, 1);
        let mut workspace = DerivativeWorkspace::default();
        let mut derivative = SolutionDerivative::new(&problem, q, &mut workspace).unwrap();
        let by_target = derivative.by_target(0).unwrap() * length;
        (derivative.existence().clone(), by_target)
    };
    let (nearly, fully) = ([0.3, 1e-4], [0.3, 0.0]);
    let (_, expected) = of(&nearly, 1.0);
    for length in [1e-4, 1e-2, 1.0, 1e3] {
        let (existence, by_target) = of(&nearly, length);
        assert_eq!(existence, Existence::Unique, "{length}");
        let off = (by_target - &expected).amax() / expected.amax();
        assert!(off < 1e-9, "{length}: {off:e}");
        let singular = NoDerivative::Singular { directions: 1 };
        let (existence, _) = of(&fully, length);
        assert_eq!(existence, Existence::DoesNotExist(singular), "{length}");
    }
}

#[test]
fn what_is_asked_twice_is_asked_once_in_any_unit() {
    let q = [0.3, 0.5, -0.4, 0.9];
    for length in [1e-3, 1.0, 1e3, 1e5] {
        let (model, tip) = chain_of(4, length);
        let problem = problem_of(&model, tip, &q, 2);
        let mut workspace = DerivativeWorkspace::default();
        let derivative = SolutionDerivative::new(&problem, &q, &mut workspace).unwrap();
        let many = Existence::ShortestOfMany { directions: 2 };
        assert_eq!(*derivative.existence(), many, "{length}");
    }
}

/// Of an arm that is stretched out towards a target too far away the first joint alone turns with it, by as much as its direction does.
#[test]
fn an_arm_that_reaches_for_what_is_too_far_has_one_in_any_unit() {
    for length in [1e-6, 1e-3, 1.0, 1e3] {
        let (model, tip) = chain_of(3, length);
        let (angle, far) = (0.4_f64, 5.0 * length);
        let mut tasks = Problem::builder(&model);
        let target = [far * angle.cos(), far * angle.sin(), 0.0];
        tasks.add(Point::new(tip, target));
        let problem = tasks.build().unwrap();
        let mut workspace = DerivativeWorkspace::default();
        let q = [angle, 0.0, 0.0];
        let mut derivative = SolutionDerivative::new(&problem, &q, &mut workspace).unwrap();
        assert_eq!(*derivative.existence(), Existence::Unique, "{length}");
        let by_target = derivative.by_target(0).unwrap() * far;
        let across = [-angle.sin(), angle.cos()];
        for (joint, expected) in [1.0, 0.0, 0.0].into_iter().enumerate() {
            let turned = (0..2).map(|k| by_target[(joint, k)] * across[k]);
            let off = turned.sum::<f64>() - expected;
            assert!(off.abs() < 1e-6, "{length}, joint {joint}: {off:e}");
        }
    }
}

/// With a preference in what the targets leave, those that are asked twice are as good as once.
#[test]
fn what_a_preference_decides_it_does_in_any_unit() {
    let q = [0.3, 0.5, -0.4, 0.9];
    let of = |length: f64, times: usize| {
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
        assert_eq!(*derivative.existence(), Existence::Unique, "{length}");
        // Where the preference is moved.
        derivative.by_target(times).unwrap()
    };
    let expected = of(1.0, 1);
    for length in [1e-6, 1.0, 1e3] {
        for times in [1, 2] {
            let off = (of(length, times) - &expected).amax();
            assert!(off < 1e-6, "{length}, {times} times: {off:e}");
        }
    }
}
