//! Promise: an error in an SRDF file, or a mismatch with the robot, is reported with its line and name. No damaged file
//! makes the reader panic.

use kinopt::robot::{ParseIssue, Robot, RobotFileError, Srdf};
use support::fault_tables::ExpectedError;

const DOOR: &str = r#"<robot name="door"><link name="frame"/><link name="leaf"/><link name="handle"/>
  <joint name="hinge" type="continuous"><parent link="frame"/><child link="leaf"/></joint>
  <joint name="ball" type="spherical"><parent link="leaf"/><child link="handle"/></joint></robot>"#;

fn fault(inner: &str) -> ParseIssue {
    let robot = Robot::parse(DOOR, "door.urdf").unwrap();
    let text = format!("<robot>\n{inner}</robot>");
    match Srdf::parse(&text, "door.srdf", &robot) {
        Err(RobotFileError::Element { line: 2, fault, .. }) => fault,
        other => panic!("{text}: {other:?}"),
    }
}

#[test]
fn unknown_names_are_reported_with_their_kind() {
    for (inner, kind) in [
        (r#"<group name="g"><joint name="hing"/></group>"#, "joint"),
        (r#"<group name="g"><link name="lead"/></group>"#, "frame"),
        (
            r#"<group name="g"><chain base_link="frame" tip_link="lead"/></group>"#,
            "frame",
        ),
        (r#"<group name="g"><group name="h"/></group>"#, "group"),
        (r#"<group_state name="s" group="g"/>"#, "group"),
        (
            r#"<group name="g"/><group_state name="s" group="g"><joint name="hing" value="0"/></group_state>"#,
            "joint",
        ),
        (r#"<passive_joint name="hing"/>"#, "joint"),
        (
            r#"<end_effector name="e" group="g" parent_link="leaf"/>"#,
            "group",
        ),
        (
            r#"<group name="g"/><end_effector name="e" group="g" parent_link="lead"/>"#,
            "frame",
        ),
        (
            r#"<virtual_joint name="v" type="fixed" parent_frame="world" child_link="lead"/>"#,
            "frame",
        ),
        (
            r#"<disable_collisions link1="leaf" link2="lead"/>"#,
            "frame",
        ),
    ] {
        let ParseIssue::UnknownName(unknown) = fault(inner) else {
            panic!("{inner}")
        };
        assert_eq!(unknown.kind, kind, "{inner}");
    }
}

#[test]
fn cyclic_groups_and_unfit_values_are_named() {
    let group = "g".to_owned();
    for inner in [
        r#"<group name="g"><group name="g"/></group>"#,
        r#"<group name="g"><group name="h"/></group><group name="h"><group name="g"/></group>"#,
    ] {
        assert_eq!(
            fault(inner),
            ParseIssue::GroupWithinItself {
                group: group.clone()
            }
        );
    }
    assert_eq!(
        fault(r#"<group name="g"/><group name="g"/>"#),
        ParseIssue::RepeatedGroup { group }
    );
    let state = |joint: &str, value: &str| {
        fault(&format!(
            r#"<group name="g"/><group_state name="s" group="g"><joint name="{joint}" value="{value}"/></group_state>"#
        ))
    };
    for (joint, value, expected) in [
        ("hinge", "x", 1),
        ("hinge", "1 2", 1),
        ("hinge", "nan", 1),
        ("ball", "1 0 0", 4),
    ] {
        assert!(
            matches!(state(joint, value), ParseIssue::BadNumbers { count, .. } if count == expected)
        );
    }
    assert_eq!(
        state("ball", "0 0 0 0"),
        ParseIssue::ZeroLength { attribute: "value" }
    );
    assert_eq!(
        fault("<group/>"),
        ParseIssue::MissingAttribute { attribute: "name" }
    );
    let robot = Robot::parse(DOOR, "door.urdf").unwrap();
    Srdf::parse("<mujoco/>", "door.srdf", &robot).says("must be <robot>");
    Srdf::read("nowhere.srdf", &robot).says("nowhere.srdf");
}
