//! Promise: the derivative of an arm's solution with respect to its target is exact for six joints and minimum-norm for
//! more. Joints on active limits stay on them, which is reported.

use kinopt::Arm;
use kinopt::ik::Differentiability;
use kinopt::spatial::{Placement, Vector3};
use nalgebra as na;
use support::arms::{panda, robot};
use support::random::Random;

/// Twists about the axes of a placement, expressed in the base.
fn own_axes(at: &Placement<f64>) -> na::Matrix6<f64> {
    let rotation: na::Matrix3<f64> = at.rotation.into();
    let mut twists = na::Matrix6::zeros();
    twists.fixed_view_mut::<3, 3>(0, 0).copy_from(&rotation);
    twists.fixed_view_mut::<3, 3>(3, 3).copy_from(&rotation);
    twists
}

#[test]
fn derivative_of_six_joints_is_exact() {
    let robot = robot("universal_ur5e");
    let arm = Arm::builder(&robot, "base", "flange").build().unwrap();
    let mut jacobian = arm.jacobian().unwrap();
    let mut random = Random::split_mix(5);
    for _ in 0..50 {
        let q = random.configuration(&arm);
        let target = arm.base_from_tool(&q).unwrap();
        let derivative = arm.derivative(target, &q).unwrap();
        assert_eq!(derivative.differentiability, Differentiability::Unique);
        let followed = jacobian.at(&q).unwrap() * &derivative.by_target;
        let difference = (followed - own_axes(&target)).amax();
        assert!(
            difference < 1e-9 * (1.0 + derivative.by_target.amax()),
            "{difference}"
        );
    }
}

#[test]
fn derivative_of_seven_joints_has_minimum_norm() {
    let (robot, base, tip) = panda();
    let arm = Arm::builder(&robot, base, tip).build().unwrap();
    let mut jacobian = arm.jacobian().unwrap();
    let mut random = Random::split_mix(6);
    for _ in 0..50 {
        let q = random.configuration(&arm);
        let target = arm.base_from_tool(&q).unwrap();
        let derivative = arm.derivative(target, &q).unwrap();
        let many = Differentiability::ShortestOfMany { directions: 1 };
        assert_eq!(derivative.differentiability, many);
        let inverse = jacobian.at(&q).unwrap().clone().pseudo_inverse(1e-12);
        let shortest = inverse.unwrap() * own_axes(&target);
        let difference = (&derivative.by_target - &shortest).amax();
        assert!(difference < 1e-9 * (1.0 + shortest.amax()), "{difference}");
    }
}

#[test]
fn derivative_of_a_miss_matches_repeated_solves() {
    let robot = robot("universal_ur5e");
    let arm = Arm::builder(&robot, "base", "flange").build().unwrap();
    let start = [0.3, -1.1, 1.0, -0.9, 1.1, 0.4];
    let mut target = arm.base_from_tool(&start).unwrap();
    target.translation += Vector3::new(0.9, 0.4, 0.9);
    let solution = arm.solve(target, &start).unwrap();
    assert!(!solution.reached);
    let derivative = arm.derivative(target, &solution.q).unwrap();
    assert!(
        derivative.differentiability.is_unique(),
        "{}",
        derivative.differentiability
    );
    let step = 1e-3;
    for axis in 0..3 {
        let along = |share: f64| {
            let mut moved = target;
            let mut offset = [0.0; 3];
            offset[axis] = share * step;
            moved.translation += moved.rotation * Vector3::from(offset);
            na::DVector::from_vec(arm.solve(moved, &solution.q).unwrap().q)
        };
        let shown = (along(1.0) - along(-1.0)) / (2.0 * step);
        let difference = (derivative.by_target.column(axis) - shown).amax();
        assert!(difference < 1e-3, "{axis}: {difference}");
    }
}

#[test]
fn invalid_input_is_rejected() {
    let robot = robot("universal_ur5e");
    let arm = Arm::builder(&robot, "base", "flange").build().unwrap();
    let target = arm.base_from_tool(&[0.1; 6]).unwrap();
    assert!(arm.derivative(target, &[0.1; 5]).is_err());
    assert!(arm.derivative(target, &[f64::NAN; 6]).is_err());
    let skewed = Placement::new(
        target.rotation * target.rotation,
        target.translation * f64::NAN,
    );
    assert!(arm.derivative(skewed, &[0.1; 6]).is_err());
}
