//! Promise: a Stewart platform's leg lengths equal closed-form inverse kinematics for any pose, and given leg lengths
//! determine the platform's pose.

use kinopt::ik::LoopClosure;
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{JointId, ParameterMap};
use kinopt::spatial::Placement;
use kinopt::task::FramePose;
use kinopt::{Problem, Solver};
use support::random::Random;

use crate::loops::mechanisms::Stewart;

/// Upright in the middle, with legs near their values there.
pub(crate) fn begin(stewart: &Stewart) -> Vec<f64> {
    let mut q = stewart.model.neutral();
    q[2] = 0.7;
    for slide in &stewart.slides {
        q[stewart.model.coordinate(*slide).unwrap()] = 0.75;
    }
    q
}

fn values(stewart: &Stewart, q: &[f64], joints: &[JointId]) -> Vec<f64> {
    let at = |joint: &JointId| q[stewart.model.coordinate(*joint).unwrap()];
    joints.iter().map(at).collect()
}

fn platform(stewart: &Stewart, q: &[f64]) -> Placement<f64> {
    let mut kinematics = ForwardKinematics::new(&stewart.model);
    kinematics.place(q).unwrap()[stewart.platform.index()]
}

fn assert_lengths(stewart: &Stewart, q: &[f64]) {
    let expected = stewart.lengths(&platform(stewart, q));
    for (actual, expected) in values(stewart, q, &stewart.slides).iter().zip(expected) {
        assert!((actual - expected).abs() < 2e-9, "{actual} {expected}");
    }
}

#[test]
fn inverse_kinematics_gives_leg_lengths() {
    let stewart = Stewart::new();
    let mut random = Random::new(5);
    for _ in 0..30 {
        let target = Stewart::pose(&mut random);
        let mut problem = Problem::builder(&stewart.model);
        problem.add(FramePose::new(stewart.platform, target));
        let solution = Solver::default()
            .solve_once(&problem.build().unwrap(), &begin(&stewart))
            .unwrap();
        assert!(solution.reached, "{}", solution.explain());
        assert_lengths(&stewart, &solution.q);
        for (actual, expected) in values(&stewart, &solution.q, &stewart.slides)
            .iter()
            .zip(stewart.lengths(&target))
        {
            assert!((actual - expected).abs() < 2e-6, "{actual} {expected}");
        }
    }
}

#[test]
fn forward_kinematics_gives_the_platform_pose() {
    let stewart = Stewart::new();
    let model = &stewart.model;
    // The platform depends on its legs: its free joint and the universal joints are dependent.
    let moving = model.moving_joints().iter().copied();
    let mut dependent: Vec<JointId> = moving.filter(|id| !stewart.slides.contains(id)).collect();
    dependent.dedup();
    let closure = LoopClosure::new(ParameterMap::builder(model), &dependent).unwrap();
    let mut random = Random::new(6);
    for _ in 0..30 {
        let pose = Stewart::pose(&mut random);
        let mut q = begin(&stewart);
        let lengths = stewart.lengths(&pose);
        for (slide, length) in stewart.slides.iter().zip(&lengths) {
            q[model.coordinate(*slide).unwrap()] = *length;
        }
        closure.close(&mut q).unwrap();
        assert_eq!(values(&stewart, &q, &stewart.slides), lengths);
        assert_lengths(&stewart, &q);
        // Of up to 40 assemblies of the platform the one of the start is found.
        let found = platform(&stewart, &q);
        let deviation = (found.translation - pose.translation).norm();
        assert!(deviation < 1e-7, "{deviation:e}");
        assert!(closure.gaps(&q).unwrap().iter().all(|gap| gap.is_closed()));
    }
}

#[test]
fn legs_that_do_not_fit_are_named() {
    let stewart = Stewart::new();
    let moving = stewart.hinges.clone();
    let closure = LoopClosure::new(ParameterMap::builder(&stewart.model), &moving).unwrap();
    let mut q = begin(&stewart);
    let before = q.clone();
    // The platform and all lengths are given, and no leg fits.
    let error = closure.close(&mut q).unwrap_err().to_string();
    assert_eq!(q, before);
    for leg in 0..6 {
        assert!(
            error.contains(&format!("loop `leg {leg}` is open by")),
            "{error}"
        );
    }
}
