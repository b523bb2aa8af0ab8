//! Promise: MoveIt's joint_limits.yaml adds velocity and acceleration limits and narrower positions to a robot. Errors
//! name the line.

use kinopt::Arm;
use kinopt::model::{JointId, Limits};
use kinopt::robot::Robot;
use support::arms::robot;
use support::fault_tables::ExpectedError;
use support::planar_arm;

const LIMITS: &str = "
default_velocity_scaling_factor: 0.1
joint_limits:
  joint1:
    has_velocity_limits: true
    max_velocity: 1.5
    has_acceleration_limits: true
    max_acceleration: 3.75
    has_jerk_limits: false
  joint2:
    has_velocity_limits: false
    min_position: -0.5
    max_position: 0.25
  joint3: {max_acceleration: 7.5}
";

fn with_limits(text: &str) -> Result<Robot, String> {
    let robot = robot("franka_panda").with_joint_limits_of(text.as_bytes(), "limits.yaml");
    robot.map_err(|error| error.to_string())
}

fn limits(robot: &Robot, joint: JointId) -> Option<Limits> {
    let coordinate = robot.model().coordinate(joint)?;
    robot.model().limits().nth(coordinate)
}

#[test]
fn limits_add_to_those_of_the_file() {
    let (plain, reported) = (robot("franka_panda"), with_limits(LIMITS).unwrap());
    let joint = |name: &str| reported.model().joint(name).unwrap();
    let [one, two, three, four] = ["joint1", "joint2", "joint3", "joint4"].map(joint);
    assert_eq!(reported.velocity_limit(one), Some(1.5));
    assert_eq!(reported.acceleration_limit(one), Some(3.75));
    assert_eq!(reported.velocity_limit(two), None);
    assert_eq!(reported.velocity_limit(three), plain.velocity_limit(three));
    assert_eq!(reported.acceleration_limit(three), Some(7.5));
    assert_eq!(reported.acceleration_limit(four), None);
    let narrow = limits(&reported, two).unwrap();
    assert_eq!((narrow.lower, narrow.upper), (-0.5, 0.25));
    assert_eq!(limits(&reported, one), limits(&plain, one));
    let arm = Arm::new(&reported, "base", "flange").unwrap();
    let inf = f64::INFINITY;
    assert_eq!(
        arm.acceleration_limits(),
        [3.75, inf, 7.5, inf, inf, inf, inf]
    );
    assert_eq!(arm.velocity_limits()[..2], [1.5, inf]);
}

#[test]
fn urdf_acceleration_and_jerk_are_limits() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/universal_ur5e.urdf");
    let text = std::fs::read_to_string(path).unwrap();
    let stated = r#"velocity="3.141592653589793" acceleration="12.5" jerk="300""#;
    let text = text.replacen(r#"velocity="3.141592653589793""#, stated, 1);
    let robot = Robot::parse(&text, "ur5e.urdf").unwrap();
    assert!(robot.repairs().is_empty(), "{:?}", robot.repairs());
    let joint = robot.model().joint("joint1").unwrap();
    assert_eq!(robot.acceleration_limit(joint), Some(12.5));
    assert_eq!(robot.jerk_limit(joint), Some(300.0));
    let arm = Arm::new(&robot, "base", "flange").unwrap();
    assert_eq!(arm.acceleration_limits()[..2], [12.5, f64::INFINITY]);
    assert_eq!(arm.jerk_limits()[..2], [300.0, f64::INFINITY]);
}

#[test]
fn shipped_panda_limits_name_every_joint() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../models/franka_panda_limits.yaml"
    );
    let robot = robot("franka_panda").with_joint_limits(path).unwrap();
    let arm = Arm::new(&robot, "base", "flange").unwrap();
    assert_eq!(
        arm.acceleration_limits(),
        [15.0, 7.5, 10.0, 12.5, 15.0, 20.0, 20.0]
    );
    let ratio = arm.jerk_limits().iter().zip(arm.acceleration_limits());
    assert!(
        ratio
            .clone()
            .all(|(jerk, acceleration)| *jerk == 500.0 * acceleration)
    );
}

/// For a robot without a file these limits are the only ones.
#[test]
fn limits_apply_to_a_robot_without_a_file() {
    let bare = Robot::new(planar_arm(&[0.5, 0.4, 0.3], None), Vec::new()).unwrap();
    let reported = "joint_limits: {joint 1: {max_velocity: 1.5, max_acceleration: 3.75}}";
    let reported = bare
        .with_joint_limits_of(reported.as_bytes(), "limits.yaml")
        .unwrap();
    let rates = reported
        .model()
        .joint_ids()
        .map(|id| (reported.velocity_limit(id), reported.acceleration_limit(id)));
    let (none, some) = ((None, None), (Some(1.5), Some(3.75)));
    assert_eq!(rates.collect::<Vec<_>>(), [none, some, none]);
}

#[test]
fn position_limits_only_narrow() {
    let wide = "joint_limits: {joint2: {has_position_limits: true, min_position: -100, max_position: 100}}";
    let (plain, reported) = (robot("franka_panda"), with_limits(wide).unwrap());
    let id = plain.model().joint("joint2").unwrap();
    assert_eq!(limits(&reported, id), limits(&plain, id));
}

/// MoveIt's files keep values that are disabled.
#[test]
fn disabled_limits_are_ignored() {
    let off = "joint_limits: {joint2: {has_position_limits: false, min_position: -0.5, max_position: 0.25,
        has_velocity_limits: false, max_velocity: 0.1, has_acceleration_limits: false, max_acceleration: 0.1}}";
    let (plain, reported) = (robot("franka_panda"), with_limits(off).unwrap());
    let id = plain.model().joint("joint2").unwrap();
    assert_eq!(limits(&reported, id), limits(&plain, id));
    assert_eq!(reported.velocity_limit(id), None);
    assert_eq!(reported.acceleration_limit(id), None);
}

#[test]
fn empty_limits_change_nothing() {
    for text in ["joint_limits:\n", "joint_limits: {}"] {
        let reported = with_limits(text).unwrap();
        let id = reported.model().joint("joint1").unwrap();
        assert_eq!(
            reported.velocity_limit(id),
            robot("franka_panda").velocity_limit(id)
        );
    }
}

#[test]
fn errors_name_the_line() {
    let cases = [
        ("", "no YAML"),
        ("joints: {}", "joint_limits"),
        ("joint_limits: [joint1]", "map of joints"),
        ("joint_limits:\n  joint11: {max_velocity: 1}", "line 2"),
        ("joint_limits:\n  joint11: {max_velocity: 1}", "joint1"),
        (
            "joint_limits:\n  joint1: {max_velocity: 0}",
            "must be above 0",
        ),
        (
            "joint_limits:\n  joint1: {max_velocity: -1}",
            "must be above 0",
        ),
        (
            "joint_limits:\n  joint1: {max_acceleration: .nan}",
            "a finite number",
        ),
        (
            "joint_limits:\n  joint1: {max_acceleration: fast}",
            "a finite number",
        ),
        (
            "joint_limits:\n  joint1: {has_velocity_limits: perhaps, max_velocity: 1}",
            "neither true nor false",
        ),
        (
            "joint_limits:\n  joint1: {has_acceleration_limits: true}",
            "has no `max_acceleration`",
        ),
        (
            "joint_limits:\n  joint2: {min_position: 1.0, max_position: -1.0}",
            "joint2",
        ),
        ("joint_limits:\n  joint1: {max_velocity: 1", "limits.yaml"),
        (
            "joint_limits:\n  joint1: {max_velocty: 1}",
            "no joint limit named `max_velocty`; did you mean `max_velocity`?",
        ),
        ("joint_limits:\n  joint1:\n    max_velocty: 1", "line 3"),
        (
            "joint_limits:\n  joint1: {max_velocity: 1}\n  joint1: {max_velocity: 2}",
            "line 3: joint `joint1` is listed twice",
        ),
    ];
    for (text, expected) in cases {
        let error = with_limits(text).unwrap_err();
        assert!(error.contains(expected), "{text:?}: {error}");
    }
    let missing = robot("franka_panda").with_joint_limits("no/such/file.yaml");
    missing.says("no/such/file.yaml");
}
