//! Promise: an arm says that a target is unreachable only with a proof. Independent answers agree: lengths of a planar
//! arm, and a fine grid over the joints of an arm of three joints.

use kinopt::arm::{Arm, PoseBounds, Reachability};
use kinopt::model::Limits;
use kinopt::robot::Robot;
use kinopt::spatial::{Matrix3, Placement, Vector3};
use support::arms::robot;
use support::random::{Random, case_count};

const MAX_BOXES: usize = 200_000;

/// Arm of two parallel joints with links of 0.5 and 0.3 m, the elbow limited to [0.5, 2].
const PLANAR: &str = r#"<robot name="planar"><link name="base"/><link name="upper"/><link name="fore"/><link name="tip"/>
  <joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="fore"/><origin xyz="0.5 0 0"/>
    <axis xyz="0 0 1"/><limit lower="0.5" upper="2" effort="1" velocity="1"/></joint>
  <joint name="end" type="fixed"><parent link="fore"/><child link="tip"/><origin xyz="0.3 0 0"/></joint></robot>"#;

fn is_unreachable(arm: &Arm, target: Placement<f64>) -> bool {
    let answer = arm
        .reachability(target, arm.default_start(), MAX_BOXES)
        .unwrap();
    match answer {
        Reachability::Reachable(solution) => assert!(solution.reached),
        Reachability::Unreachable { boxes, closest } => {
            assert!(boxes > 0 && !closest.reached && closest.is_out_of_reach());
            assert!(closest.explain().contains("Out of reach: "));
            return true;
        }
        other => panic!("{other:?}"),
    }
    false
}

#[test]
fn planar_arm_reaches_a_ring() {
    let robot = Robot::parse(PLANAR, "planar.urdf").unwrap();
    let arm = Arm::builder(&robot, "base", "tip").with_goal(PoseBounds::position());
    let arm = arm.build().unwrap();
    // Law of cosines at the limits of the elbow.
    let distance = |elbow: f64| (0.34 + 0.3 * elbow.cos()).sqrt();
    let (nearest, farthest) = (distance(2.0), distance(0.5));
    let mut random = Random::new(3);
    for _ in 0..300 {
        let (radius, angle) = (random.within(0.0, 1.0), random.within(-3.0, 3.0));
        let point = Vector3::new(radius * angle.cos(), radius * angle.sin(), 0.0);
        let gap = (nearest - radius).max(radius - farthest);
        if gap.abs() > 1e-3 {
            assert_eq!(
                is_unreachable(&arm, Placement::translation(point)),
                gap > 0.0,
                "{radius}"
            );
        }
    }
    let above = Placement::translation(Vector3::new(0.6, 0.0, 1e-3));
    assert!(is_unreachable(&arm, above));
}

#[test]
fn grid_over_three_joints_agrees() {
    let robot = robot("universal_ur5e");
    let arm = Arm::builder(&robot, "base", "flange").with_goal(PoseBounds::position());
    let locked = ["joint4", "joint5", "joint6"].map(|joint| (joint, 0.4));
    let limits = ["joint1", "joint2", "joint3"];
    let arm = locked
        .into_iter()
        .fold(arm, |arm, (joint, value)| arm.with_locked(joint, value));
    let arm = limits
        .into_iter()
        .fold(arm, |arm, joint| {
            arm.with_joint_limits(joint, Limits::new(-1.2, 0.9))
        })
        .build()
        .unwrap();
    // Every configuration is within 0.02 rad of one of the grid in each joint; the tip moves at most 1.2 m per radian.
    let steps: Vec<f64> = (0..=52).map(|step| -1.2 + 0.04 * f64::from(step)).collect();
    let mut grid = Vec::new();
    for &pan in &steps {
        for &lift in &steps {
            grid.extend(
                steps
                    .iter()
                    .map(|&elbow| arm.base_from_tool(&[pan, lift, elbow]).unwrap().translation),
            );
        }
    }
    let reach_of_cell = 3.0 * 0.02 * 1.2;
    let mut random = Random::new(4);
    let (mut proven, mut far) = (0, 0);
    for _ in 0..60 {
        let point = Vector3::new(
            random.within(-1.0, 1.0),
            random.within(-1.0, 1.0),
            random.within(-0.6, 1.2),
        );
        let distances = grid.iter().map(|tip| (*tip - point).norm());
        let distance = distances.fold(f64::INFINITY, f64::min);
        let unreachable = is_unreachable(&arm, Placement::translation(point));
        if distance > reach_of_cell {
            assert!(unreachable, "{distance}");
            far += 1;
        }
        proven += usize::from(unreachable);
    }
    assert!(far > 20 && proven < 60, "{far} {proven}");
}

#[test]
fn proofs_hold_for_six_and_seven_joints() {
    for (model, base, tip) in [
        ("franka_panda", "base", "flange"),
        ("universal_ur5e", "base", "flange"),
    ] {
        let robot = robot(model);
        let arm = Arm::new(&robot, base, tip).unwrap();
        let wide = Arm::builder(&robot, base, tip)
            .with_attempts(500)
            .build()
            .unwrap();
        let mut random = Random::new(8);
        let mut proven = 0;
        for _ in 0..case_count(30, 12) {
            let rotation =
                Matrix3::from_roll_pitch_yaw([0.0; 3].map(|_: f64| random.within(-3.0, 3.0)));
            let position = Vector3::new(
                random.within(-0.9, 0.9),
                random.within(-0.9, 0.9),
                random.within(0.0, 1.0),
            );
            let target = Placement::new(rotation, position);
            let answer = arm
                .reachability(target, arm.default_start(), 20_000)
                .unwrap();
            if answer.is_reachable() == Some(false) {
                proven += 1;
                assert!(!wide.solve(target, arm.default_start()).unwrap().reached);
            }
        }
        assert!(proven >= 2, "{model}: {proven}");
    }
}

#[test]
fn chains_without_a_proof_are_undecided() {
    let robot = robot("universal_ur5e");
    let bounds = PoseBounds::free_along(kinopt::arm::Axis::X);
    let arm = Arm::builder(&robot, "base", "flange")
        .with_goal(bounds)
        .build()
        .unwrap();
    let far = Placement::translation(Vector3::new(0.0, 5.0, 0.0));
    let answer = arm
        .reachability(far, arm.default_start(), MAX_BOXES)
        .unwrap();
    assert_eq!((answer.is_reachable(), answer.boxes()), (None, 0));
}
