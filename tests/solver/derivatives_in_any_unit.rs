//! Promise: whether a solution has a derivative, and which, does not depend on the unit of length.
#![allow(clippy::unwrap_used)]

use kinopt::Problem;
use kinopt::ik::{DerivativeWorkspace, Existence, NoDerivative, SolutionDerivative};
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{FrameId, Model};
use kinopt::task::Point;
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
