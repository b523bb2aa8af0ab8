//! Promise: joint limits of an arm narrow those of the model, for solutions, the default start and random configurations.

use kinopt::arm::{Arm, ArmError};
use kinopt::model::Limits;
use kinopt::robot::Robot;

fn robot() -> Robot {
    Robot::read("../models/franka_panda.urdf").unwrap()
}

#[test]
fn solutions_stay_within_narrowed_limits() {
    let robot = robot();
    let limits = Limits::new(0.2, 0.5);
    let arm = Arm::builder(&robot, "base", "tool").with_joint_limits("joint3", limits);
    let arm = arm.build().unwrap();
    assert_eq!(arm.limits().nth(2), Some(limits));
    assert!((arm.default_start()[2] - 0.35).abs() < 1e-12);
    let wide = Arm::new(&robot, "base", "tool").unwrap();
    let mut reached = 0;
    for seed in 0..100 {
        let target = wide
            .base_from_tool(&arm.random_configuration(seed))
            .unwrap();
        let solution = arm.solve(target, arm.default_start()).unwrap();
        assert!(limits.contains(solution.q[2]));
        reached += usize::from(solution.reached);
    }
    assert!(reached > 95, "{reached}");
}

#[test]
fn limits_that_widen_are_errors() {
    let robot = robot();
    for (lower, upper) in [(-3.0, 0.0), (0.0, 3.0), (1.0, -1.0), (f64::NAN, 1.0)] {
        let arm = Arm::builder(&robot, "base", "tool");
        let arm = arm.with_joint_limits("joint1", Limits::new(lower, upper));
        let error = arm.build().unwrap_err();
        assert!(matches!(error, ArmError::JointLimits { .. }), "{error}");
        assert!(error.to_string().contains("`joint1`"), "{error}");
    }
    let unknown =
        Arm::builder(&robot, "base", "tool").with_joint_limits("joint_1", Limits::new(0.0, 1.0));
    assert!(unknown.build().unwrap_err().to_string().contains("joint1"));
}

#[test]
fn random_configurations_fill_the_limits() {
    let arm = Arm::new(&robot(), "base", "tool").unwrap();
    let samples: Vec<_> = (0..500)
        .map(|seed| arm.random_configuration(seed))
        .collect();
    for (joint, limits) in arm.limits().enumerate() {
        let shares = samples
            .iter()
            .map(|q| (q[joint] - limits.lower) / (limits.upper - limits.lower));
        let shares: Vec<f64> = shares.collect();
        assert!(shares.iter().all(|share| (0.0..=1.0).contains(share)));
        let mean = shares.iter().sum::<f64>() / 500.0;
        // The standard deviation of the mean of a uniform variable is 0.29 / √500 = 0.013.
        assert!((mean - 0.5).abs() < 0.06, "{mean}");
    }
    assert_eq!(arm.random_configuration(7), samples[7]);
}
