//! Promise: an arm's Jacobian is the derivative of its tool pose, between any two frames and with mimic joints.
//! Non-finite input is named in the error.

use kinopt::arm::{Arm, QueryError};
use kinopt::robot::Robot;
use kinopt::spatial::{Matrix3, Placement, Vector3};
use support::arms::robot;
use support::follower_chains::follower_chain;
use support::random::Random;

const STEP: f64 = 1e-6;

/// Twist of the tool per unit of one joint, by central differences.
fn twist(arm: &Arm, q: &[f64], joint: usize) -> [f64; 6] {
    let at = |step: f64| {
        let mut q = q.to_vec();
        q[joint] += step;
        arm.base_from_tool(&q).unwrap()
    };
    let (ahead, behind) = (at(STEP), at(-STEP));
    let linear = (ahead.translation - behind.translation) * (0.5 / STEP);
    // The angular velocity is half the sum of the axes crossed with their differences.
    let axes = |m: &Matrix3<f64>| [m.x, m.y, m.z];
    let tool_axes = axes(&arm.base_from_tool(q).unwrap().rotation);
    let (ahead, behind) = (axes(&ahead.rotation), axes(&behind.rotation));
    let mut angular = Vector3::zero();
    for k in 0..3 {
        let rate = (ahead[k] - behind[k]) * (0.5 / STEP);
        angular += tool_axes[k].cross(rate) * 0.5;
    }
    let ([a, b, c], [d, e, f]) = (linear.to_array(), angular.to_array());
    [a, b, c, d, e, f]
}

fn holds_for(arm: &Arm, seed: u64) {
    let mut random = Random::split_mix(seed);
    let mut jacobian = arm.jacobian().unwrap();
    for _ in 0..4 {
        let q = random.configuration(arm);
        let matrix = jacobian.at(&q).unwrap();
        assert_eq!(matrix.shape(), (6, arm.joint_count()));
        for joint in 0..arm.joint_count() {
            for (entry, by_differences) in matrix.column(joint).iter().zip(twist(arm, &q, joint)) {
                assert!(
                    (entry - by_differences).abs() < 1e-7,
                    "{entry} {by_differences}"
                );
            }
        }
    }
}

#[test]
fn jacobian_matches_differences_for_any_frames() {
    let panda = robot("franka_panda");
    let tool = Placement::translation(Vector3::new(0.1, -0.2, 0.3));
    for (base, tip) in [("base", "flange"), ("link3", "tool"), ("flange", "link1")] {
        let arm = Arm::builder(&panda, base, tip).with_tool(tool);
        holds_for(&arm.with_atlas(false).build().unwrap(), 3);
    }
}

#[test]
fn mimic_joints_add_to_source_joint_columns() {
    let mut arms = 0;
    for number in 0..12 {
        let (text, tip) = follower_chain(number);
        let Ok(robot) = Robot::parse(&text, "followers.urdf") else {
            continue;
        };
        let arm = Arm::builder(&robot, "l0", &tip).with_atlas(false);
        holds_for(&arm.build().unwrap(), number);
        arms += 1;
    }
    assert!(arms > 6, "{arms}");
}

#[test]
fn non_finite_joint_is_named_in_the_error() {
    let panda = robot("franka_panda");
    let arm = Arm::builder(&panda, "base", "flange").with_atlas(false);
    let arm = arm.build().unwrap();
    let mut q = vec![0.0; 7];
    q[2] = f64::NAN;
    let error = arm.base_from_tool(&q).unwrap_err();
    assert!(
        matches!(&error, QueryError::NotFinite { joint, .. } if joint == "joint3"),
        "{error}"
    );
    assert!(arm.jacobian().unwrap().at(&q).is_err());
}
