//! Promise: the default start of an arm is a state of its SRDF file or the middle of its limits. Near targets have near
//! solutions from it.

use kinopt::arm::{Arm, PoseBounds};
use kinopt::robot::{Robot, Srdf};
use kinopt::spatial::{Placement, Vector3};
use support::arms::robot;
use support::random::Random;

/// A revolute, a continuous and two prismatic joints.
const MIXED: &str = r#"<robot name="mixed"><link name="l0"/><link name="l1"/><link name="l2"/><link name="l3"/><link name="l4"/>
  <joint name="a" type="revolute"><parent link="l0"/><child link="l1"/><limit lower="-1" upper="3"/></joint>
  <joint name="b" type="continuous"><parent link="l1"/><child link="l2"/><axis xyz="0 1 0"/></joint>
  <joint name="c" type="prismatic"><parent link="l2"/><child link="l3"/><limit lower="0.2" upper="0.6"/></joint>
  <joint name="d" type="prismatic"><parent link="l3"/><child link="l4"/><limit lower="0.5" upper="0.9"/></joint></robot>"#;

fn mixed() -> Robot {
    Robot::parse(MIXED, "mixed.urdf").unwrap()
}

#[test]
fn default_start_is_the_middle_of_the_limits() {
    let arm = Arm::new(&mixed(), "l0", "l4").unwrap();
    for (value, middle) in arm.default_start().iter().zip([1.0, 0.0, 0.4, 0.7]) {
        assert!((value - middle).abs() < 1e-15, "{:?}", arm.default_start());
    }
    // Derived arms keep it.
    let tool = Placement::translation(Vector3::new(0.0, 0.0, 0.1));
    let copy = arm
        .with_tool(tool)
        .unwrap()
        .with_goal(PoseBounds::position())
        .unwrap();
    assert_eq!(copy.default_start(), arm.default_start());
}

#[test]
fn default_start_is_the_srdf_state_of_the_arm() {
    let robot = mixed();
    let state = |name: &str, group: &str, joint: &str, value: f64| {
        format!(
            "<group_state name='{name}' group='{group}'><joint name='{joint}' value='{value}'/></group_state>"
        )
    };
    let started = |states: &str| {
        let text = format!(
            "<robot name='mixed'><group name='arm'><joint name='a'/></group><group name='slide'><joint name='d'/></group>{states}</robot>"
        );
        let srdf = Srdf::parse(&text, "mixed.srdf", &robot).unwrap();
        let arm = Arm::new(&robot, "l0", "l3").unwrap().with_srdf(&srdf);
        arm.default_start()[0]
    };
    let (home, ready) = (
        state("home", "arm", "a", 0.5),
        state("ready", "arm", "a", -0.5),
    );
    assert_eq!(started(&home), 0.5);
    assert_eq!(started(&(home.clone() + &ready)), -0.5);
    // States of joints outside the arm do not define its start.
    let other = state("ready", "slide", "d", 0.8);
    assert_eq!(started(&(other.clone() + &home)), 0.5);
    assert_eq!(started(&other), 1.0);
    // A value beyond the limits is clamped.
    assert_eq!(started(&state("Home", "arm", "a", -7.0)), -1.0);
}

#[test]
fn near_targets_stay_near_the_default_start() {
    let arm = Arm::new(&robot("franka_panda"), "base", "flange").unwrap();
    let mut random = Random::split_mix(3);
    let start = arm.default_start();
    for _ in 0..200 {
        let near: Vec<f64> = (start.iter().zip(arm.limits()))
            .map(|(value, limits)| limits.clamp(value + 0.6 * (random.unit() - 0.5)))
            .collect();
        let target = arm.base_from_tool(&near).unwrap();
        let solution = arm.solve(target, start).unwrap();
        assert!(solution.reached);
        let moved = solution.q.iter().zip(start).map(|(a, b)| (a - b).abs());
        assert!(moved.fold(0.0, f64::max) < 1.0, "{:?}", solution.q);
    }
}
