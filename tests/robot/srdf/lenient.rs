//! Promise: the lenient reader omits exactly the elements that name unknown things, and lists each with its line. The
//! strict reader rejects the same file.

use kinopt::robot::{ParseIssue, RepairKind, Robot, Srdf};

const DOOR: &str = r#"<robot name="door"><link name="frame"/><link name="leaf"/><link name="handle"/>
  <joint name="hinge" type="continuous"><parent link="frame"/><child link="leaf"/></joint>
  <joint name="latch" type="continuous"><parent link="leaf"/><child link="handle"/></joint></robot>"#;

/// Every other line has an unknown name.
const OTHER_DOOR: &str = r#"<robot name="door">
<virtual_joint name="v" type="fixed" parent_frame="world" child_link="lead"/>
<group name="all"><joint name="hinge"/>
<joint name="v"/><joint name="hing"/>
<link name="handle"/>
<link name="lead"/>
<chain base_link="frame" tip_link="leaf"/>
<chain base_link="frame" tip_link="lead"/></group>
<group name="outer"><group name="all"/><group name="inner"/></group>
<group name="all"><joint name="latch"/></group>
<group_state name="shut" group="all"><joint name="hinge" value="0.5"/>
<joint name="hing" value="1"/><joint name="latch" value="one"/><joint name="v" value="0"/></group_state>
<group_state name="shut" group="inner"/>
<end_effector name="e" group="all" parent_link="handle"/>
<end_effector name="f" group="inner" parent_link="handle"/>
<passive_joint name="latch"/>
<passive_joint name="hing"/>
<disable_collisions link1="frame" link2="leaf"/>
<disable_collisions link1="frame" link2="lead"/>
</robot>"#;

fn lenient(text: &str) -> Srdf {
    let robot = Robot::parse(DOOR, "door.urdf").unwrap();
    assert!(Srdf::parse(text, "door.srdf", &robot).is_err());
    let reader = Srdf::reader().lenient();
    reader.parse(text, "door.srdf", &robot).unwrap()
}

#[test]
fn unknown_names_are_omitted_and_listed_by_line() {
    let robot = Robot::parse(DOOR, "door.urdf").unwrap();
    let both = ["hinge", "latch"].map(|name| robot.model().joint(name).unwrap());
    let srdf = lenient(OTHER_DOOR);
    assert!(srdf.virtual_joints.is_empty());
    assert_eq!(srdf.groups.len(), 2);
    assert_eq!(srdf.group("all").unwrap().joints, both);
    assert_eq!(srdf.group("outer").unwrap().joints, both);
    assert_eq!(srdf.states.len(), 1);
    assert_eq!(srdf.states[0].values, [(0, 0.5)]);
    assert_eq!(srdf.end_effectors.len(), 1);
    assert_eq!(srdf.passive_joints, both[1..]);
    assert_eq!(srdf.disabled_pairs.len(), 1);
    let lines: Vec<u32> = srdf.repairs.iter().map(|repair| repair.line).collect();
    assert_eq!(lines, [2, 4, 6, 8, 9, 10, 12, 12, 13, 15, 17, 19]);
    for repair in &srdf.repairs {
        match (&repair.mended, repair.line) {
            (RepairKind::FirstCounts { child }, 10) => assert_eq!(*child, "group"),
            (RepairKind::LeftOut(ParseIssue::BadNumbers { text, .. }), 12) => {
                assert_eq!(text, "one")
            }
            (RepairKind::LeftOut(ParseIssue::UnknownName(unknown)), _) => {
                assert!(["hing", "lead", "inner"].contains(&&*unknown.name));
            }
            (other, line) => panic!("{line}: {other:?}"),
        }
    }
}

#[test]
fn valid_file_is_read_as_by_the_strict_reader() {
    let robot = Robot::parse(DOOR, "door.urdf").unwrap();
    let text = r#"<robot name="door"><group name="g"><joint name="hinge"/></group>
        <group_state name="s" group="g"><joint name="hinge" value="0.5"/></group_state></robot>"#;
    let strict = Srdf::parse(text, "door.srdf", &robot).unwrap();
    assert!(strict.repairs.is_empty());
    let reader = Srdf::reader().lenient();
    assert_eq!(reader.parse(text, "door.srdf", &robot).unwrap(), strict);
}

#[test]
fn cyclic_groups_have_the_joints_of_all() {
    let srdf = lenient(
        r#"<robot><group name="g"><joint name="hinge"/><group name="h"/></group>
        <group name="h"><joint name="latch"/><group name="g"/></group>
        <group name="own"><joint name="latch"/><group name="own"/></group></robot>"#,
    );
    let counts: Vec<usize> = srdf.groups.iter().map(|g| g.joints.len()).collect();
    assert_eq!(counts, [2, 2, 1]);
    assert_eq!(srdf.repairs.len(), 3);
}

#[test]
fn non_srdf_files_are_rejected_by_both_readers() {
    let robot = Robot::parse(DOOR, "door.urdf").unwrap();
    let reader = Srdf::reader().lenient();
    for text in ["", "<mujoco/>", "<robot>", "<robot></group>"] {
        assert!(reader.parse(text, "door.srdf", &robot).is_err(), "{text}");
    }
    assert!(reader.read("nowhere.srdf", &robot).is_err());
}
