//! Promise: whether a solution has a derivative, and which, does not depend on the unit of length, nor on how far an arm is from full
//! stretch.
#![allow(clippy::unwrap_used)]

use kinopt::Problem;
use kinopt::ik::{DerivativeWorkspace, Existence, NoDerivative, SolutionDerivative};
use kinopt::kinematics::{ForwardKinematics, frame_jacobian};
use kinopt::model::{FrameId, Limits, Model};
use kinopt::spatial::{Placement, Vector3};
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

/// Whether an arm is stretched does not depend on the unit of length.
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

/// Towards full stretch less and less is left of what bends the elbow; both ways through the Jacobian's inverse keep their digits.
#[test]
fn nearly_stretched_forward_and_backward_are_the_inverse() {
    let [x, y, z] = Vector3::UNITS;
    let (limits, link) = (Limits::new(-2.0, 2.0), Placement::translation(x));
    let mut builder = Model::builder("arm");
    let turn = builder.revolute("turn", None, Placement::identity(), z, limits);
    let lift = builder.revolute("lift", Some(turn), Placement::identity(), y, limits);
    let elbow = builder.revolute("elbow", Some(lift), link, y, limits);
    let tip = builder.frame("tip", Some(elbow), link);
    let model = builder.build().unwrap();
    for bent in [0.003, 0.01, 0.03, 0.1, 0.3] {
        let q = [0.4, 0.7, bent];
        let problem = problem_of(&model, tip, &q, 1);
        let mut workspace = DerivativeWorkspace::default();
        let mut derivative = SolutionDerivative::new(&problem, &q, &mut workspace).unwrap();
        let jacobian = frame_jacobian(&model, tip, &q).unwrap();
        let inverse = jacobian.rows(0, 3).into_owned().try_inverse().unwrap();
        let size = inverse.amax();
        let forward = derivative.by_target(0).unwrap();
        assert!((forward - &inverse).amax() < 1e-9 * size, "{bent}");
        let slope = [0.3, -0.2, 0.9];
        let mut gradient = derivative.parameters();
        derivative.gradient(&slope, &mut gradient).unwrap();
        let expected = inverse.transpose() * nalgebra::Vector3::from(slope);
        let told = nalgebra::DVector::from_column_slice(gradient.target(0));
        assert!((told - expected).amax() < 1e-9 * size, "{bent}");
    }
}
