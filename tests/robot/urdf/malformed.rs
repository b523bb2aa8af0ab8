//! Promise: every defect of a URDF file is an error that names the file, line, element and problem. None becomes a
//! silent default.

use kinopt::model::ModelError;
use kinopt::robot::{ParseIssue, Robot, RobotFileError};
use support::fault_tables::faults;

/// A valid robot of two joints, to be damaged.
const VALID_ROBOT: &str = r#"<?xml version="1.0"?>
<robot name="two">
  <link name="base"/>
  <link name="upper"/>
  <link name="fore"/>
  <joint name="shoulder" type="revolute">
    <origin xyz="0 0 0.5" rpy="0 0.1 0"/>
    <parent link="base"/>
    <child link="upper"/>
    <axis xyz="0 1 0"/>
    <limit lower="-1" upper="2" velocity="1" effort="10"/>
  </joint>
  <joint name="elbow" type="prismatic">
    <origin xyz="0 0 0.4" rpy="0 0 0"/>
    <parent link="upper"/>
    <child link="fore"/>
    <axis xyz="0 0 1"/>
    <limit lower="0" upper="0.3" velocity="1" effort="10"/>
  </joint>
</robot>
"#;

fn parse(text: &str) -> Result<Robot, RobotFileError> {
    Robot::parse(text, "two.urdf")
}

/// The valid robot with one passage replaced, which must exist.
fn damaged(from: &str, to: &str) -> String {
    assert!(VALID_ROBOT.contains(from), "{from}");
    VALID_ROBOT.replacen(from, to, 1)
}

#[test]
fn valid_robot_is_read() {
    assert_eq!(parse(VALID_ROBOT).unwrap().model().degrees_of_freedom(), 2);
}

/// Faults that replace one passage, and their complete messages.
const FAULTS: &str = r#"
<limit lower="-1" upper="2" velocity="1" effort="10"/> =>  | two.urdf:6: joint `shoulder`: a revolute joint needs <limit>; type `continuous` has none
<limit lower="0" upper="0.3" velocity="1" effort="10"/> =>  | two.urdf:13: joint `elbow`: a prismatic joint needs <limit>
upper="2" => upper="-1.5" | two.urdf:11: joint `shoulder`, <limit>: lower limit -1 is above upper limit -1.5
upper="2" => upper="inf" | two.urdf:11: joint `shoulder`, <limit>: attribute `upper` must be 1 finite number(s), not `inf`
lower="-1" => lower="NaN" | two.urdf:11: joint `shoulder`, <limit>: attribute `lower` must be 1 finite number(s), not `NaN`
upper="2" => uper="2" | two.urdf:11: joint `shoulder`, <limit>: `uper` is not known; `upper` may be meant
effort="10"/> => effort="ten"/> | two.urdf:11: joint `shoulder`, <limit>: attribute `effort` must be 1 finite number(s), not `ten`
<axis xyz="0 1 0"/> => <axis xyz="0 0 0"/> | two.urdf:10: joint `shoulder`, <axis>: the axis is zero; it must have a direction
<axis xyz="0 1 0"/> => <axis/> | two.urdf:10: joint `shoulder`, <axis>: attribute `xyz` is missing or empty
<axis xyz="0 1 0"/> => <axis xyz="0 1"/> | two.urdf:10: joint `shoulder`, <axis>: attribute `xyz` must be 3 finite number(s), not `0 1`
<axis xyz="0 1 0"/> => <axis xyz="0, 1, 0"/> | two.urdf:10: joint `shoulder`, <axis>: attribute `xyz` must be 3 finite number(s), not `0, 1, 0`
<axis xyz="0 1 0"/> => <axis xyz="0 1 0"/><axis xyz="0 1 0"/> | two.urdf:10: joint `shoulder`: <axis> is given twice
<axis xyz="0 1 0"/> => <axis xyz="0 1 0"/>\n<axis xyz="0 1 0"/>\n<axis xyz="0 1 0"/> | two.urdf:11: joint `shoulder`: <axis> is given twice
rpy="0 0.1 0" => rpy="0 1e999 0" | two.urdf:7: joint `shoulder`, <origin>: attribute `rpy` must be 3 finite number(s), not `0 1e999 0`
xyz="0 0 0.5" => xzy="0 0 0.5" | two.urdf:7: joint `shoulder`, <origin>: `xzy` is not known; `xyz` may be meant
<origin xyz="0 0 0.5" => <Origin xyz="0 0 0.5" | two.urdf:7: joint `shoulder`: `Origin` is not known; `origin` may be meant
rpy="0 0.1 0" => quat_xyzw="0 0 0 1" | two.urdf:7: joint `shoulder`, <origin>: attribute `quat_xyzw` needs <robot version="1.1">
revolute => hinge | two.urdf:6: joint `shoulder`: joint type `hinge` is not known; valid types: revolute, continuous, prismatic, fixed, floating, planar, spherical
 type="revolute" =>  | two.urdf:6: joint `shoulder`: attribute `type` is missing or empty
<joint name="shoulder"  => <joint  | two.urdf:6: <joint>: attribute `name` is missing or empty
<link name="upper"/> => <link name=" "/> | two.urdf:4: <link>: attribute `name` is missing or empty
 name="two" =>  | two.urdf:2: <robot>: attribute `name` is missing or empty
name="elbow" => name="shoulder" | two.urdf:13: joint `shoulder`: the name is already used on line 6
<link name="fore"/> => <link name="upper"/> | two.urdf:5: link `upper`: the name is already used on line 4
<child link="fore"/> => <child link="hand"/> | two.urdf:13: joint `elbow`: no link named `hand`; valid names: base, upper, fore
<parent link="base"/> => <parent link="world"/> | two.urdf:6: joint `shoulder`: no link named `world`; valid names: base, upper, fore
<parent link="base"/> =>  | two.urdf:6: joint `shoulder`: <parent> is missing
<parent link="base"/> => <parent/> | two.urdf:8: joint `shoulder`, <parent>: attribute `link` is missing or empty
<child link="fore"/> => <child link="upper"/> | two.urdf:13: joint `elbow`: its child link `upper` is already the child of joint `shoulder`
<parent link="base"/> => <parent link="fore"/> | two.urdf:6: joint `shoulder`: the joint is part of a cycle; links and joints must form a tree
<parent link="upper"/> => <parent link="fore"/> | two.urdf:13: joint `elbow`: the joint is part of a cycle; links and joints must form a tree
<link name="fore"/> => <link name="fore"/><link name="loose"/> | two.urdf:2: <robot>: links base, loose all have no parent joint; a robot has one root
<axis xyz="0 0 1"/> => <axis xyz="0 0 1"/><mimic joint="wrist"/> | two.urdf:13: joint `elbow`: no joint named `wrist`; valid names: shoulder, elbow
<axis xyz="0 0 1"/> => <axis xyz="0 0 1"/><mimic multiplier="2"/> | two.urdf:17: joint `elbow`, <mimic>: attribute `joint` is missing or empty
<axis xyz="0 0 1"/> => <axis xyz="0 0 1"/><mimic joint="shoulder" multiplier="two"/> | two.urdf:17: joint `elbow`, <mimic>: attribute `multiplier` must be 1 finite number(s), not `two`
<axis xyz="0 0 1"/> => <axis xyz="0 0 1"/><mimic joint="elbow"/> | two.urdf: joint `elbow` is its own source through mimic joints
<robot name="two"> => <robot name="two" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:property name="l" value="1"/> | two.urdf:2: this is xacro, not URDF: expand it first with `xacro IN > OUT.urdf` (`pip install xacro`; in Python `Robot.from_xacro`)
<link name="base"/> => <xacro:include filename="arm.xacro"/> | two.urdf:3: this is xacro, not URDF: expand it first with `xacro IN > OUT.urdf` (`pip install xacro`; in Python `Robot.from_xacro`)
xyz="0 0 0.5" => xyz="0 0 ${height}" | two.urdf:7: this is xacro, not URDF: expand it first with `xacro IN > OUT.urdf` (`pip install xacro`; in Python `Robot.from_xacro`)
"#;

#[test]
fn each_defect_is_named_with_its_location() {
    for fault in faults(FAULTS) {
        match parse(&damaged(&fault.from, &fault.to)) {
            Ok(_) => panic!("`{}` -> `{}` was read", fault.from, fault.to),
            Err(error) => assert_eq!(error.to_string(), fault.parts.concat()),
        }
    }
}

#[test]
fn invalid_documents_are_named() {
    for text in ["", "robot", "<robot", "<robot name='r'>", "<a/><b/>", "\0"] {
        let error = parse(text).unwrap_err();
        assert!(
            matches!(error, RobotFileError::NotXml { .. }),
            "{text}: {error}"
        );
        assert!(error.to_string().starts_with("two.urdf: not well-formed"));
    }
    // Entities may expand without bound; URDF needs none.
    let doctype = VALID_ROBOT.replace("<robot", "<!DOCTYPE r [<!ENTITY a \"b\">]><robot");
    assert!(matches!(
        parse(&doctype),
        Err(RobotFileError::NotXml { .. })
    ));
    let sdf = "<sdf version='1.7'><model name='m'/></sdf>";
    assert_eq!(
        parse(sdf).unwrap_err().to_string(),
        "two.urdf:1: <sdf>: the root element must be <robot>"
    );
    assert!(matches!(
        parse("<robot name='nobody'/>").unwrap_err(),
        RobotFileError::Element {
            fault: ParseIssue::NoLinks,
            line: 1,
            ..
        }
    ));
}

#[test]
fn cycle_without_a_root_is_found() {
    let text = damaged(r#"<link name="fore"/>"#, "")
        .replace(r#"<child link="fore"/>"#, r#"<child link="base"/>"#);
    assert!(matches!(
        parse(&text).unwrap_err(),
        RobotFileError::Element {
            fault: ParseIssue::Cycle,
            ..
        }
    ));
}

/// Joints below a cycle are not reported, in any order.
#[test]
fn joint_of_the_cycle_is_named() {
    let joint = |name: &str, parent: &str, child: &str| {
        format!(
            "<joint name=\"{name}\" type=\"fixed\"><parent link=\"{parent}\"/><child link=\"{child}\"/></joint>"
        )
    };
    let joints = [
        joint("tail end", "c", "d"),
        joint("tail", "b", "c"),
        joint("there", "a", "b"),
        joint("back", "b2", "a"),
        joint("on", "b", "b2"),
    ];
    let links = ["root", "a", "b", "b2", "c", "d"].map(|link| format!("<link name=\"{link}\"/>"));
    for turn in 0..joints.len() {
        let mut joints = joints.to_vec();
        joints.rotate_left(turn);
        let text = format!(
            "<robot name=\"ring\">{}{}</robot>",
            links.concat(),
            joints.concat()
        );
        let message = parse(&text).unwrap_err().to_string();
        let named = ["`there`", "`back`", "`on`"];
        assert!(named.iter().any(|name| message.contains(name)), "{message}");
        assert!(message.contains("cycle"), "{message}");
    }
}

#[test]
fn missing_or_binary_file_is_named() {
    let error = Robot::read("../models/no_such_robot.urdf").unwrap_err();
    let message = error.to_string();
    assert!(message.starts_with("../models/no_such_robot.urdf: cannot be read: "));
    let message = Robot::read("../models").unwrap_err().to_string();
    assert_eq!(message, "../models: is not a regular file");

    let path = std::env::temp_dir().join(format!("kinopt_latin1_{}.urdf", std::process::id()));
    std::fs::write(&path, b"<robot name='\xe9t\xe9'/>").unwrap();
    let error = Robot::read(&path).unwrap_err();
    std::fs::remove_file(&path).unwrap();
    assert!(error.to_string().ends_with("is not UTF-8 text"), "{error}");
}

#[test]
fn long_mimic_cycle_is_found() {
    let joints: String = (0..40)
        .map(|i| {
            format!(
                "<link name='l{i}'/><joint name='j{i}' type='revolute'><parent link='{}'/>\
                 <child link='l{i}'/><limit lower='-1' upper='1' velocity='1'/>\
                 <mimic joint='j{}'/></joint>",
                if i == 0 {
                    "base".into()
                } else {
                    format!("l{}", i - 1)
                },
                (i + 1) % 40
            )
        })
        .collect();
    let ring = format!("<robot name='ring'><link name='base'/>{joints}</robot>");
    assert!(matches!(
        parse(&ring),
        Err(RobotFileError::Model {
            source: ModelError::CouplingCycle { .. },
            ..
        })
    ));
}

#[test]
fn mimic_of_a_fixed_joint_is_rejected() {
    let text = damaged("revolute", "fixed").replace(
        "<axis xyz=\"0 0 1\"/>",
        r#"<axis xyz="0 0 1"/><mimic joint="shoulder"/>"#,
    );
    assert_eq!(
        parse(&text).unwrap_err().to_string(),
        "two.urdf: joint `shoulder` is fixed and cannot be followed"
    );
}

#[test]
fn faults_outside_kinematics_are_no_errors() {
    let text = damaged(
        r#"<link name="upper"/>"#,
        r#"<link name="upper"><inertial><mass value="heavy"/></inertial>
           <visual><geometry><mesh filename="package://nowhere/upper.dae"/></geometry></visual>
           <visual><geometry><torus/></geometry></visual>
           <collision><geometry><box size="1"/></geometry></collision></link>
           <transmission name="t"><joint name="shoulder"/></transmission>
           <gazebo reference="upper"><link name="upper"/></gazebo>"#,
    )
    .replace(
        "<axis xyz=\"0 0 1\"/>",
        "<axis xyz=\"0 0 1\"/><dynamics damping=\"much\"/><hardware/>",
    );
    let robot = parse(&text).unwrap();
    assert_eq!(robot.model().degrees_of_freedom(), 2);
    assert_eq!(robot.model().frames().len(), 3);
}

#[test]
fn foreign_namespaces_are_ignored() {
    let text = damaged(
        r#"<robot name="two">"#,
        r#"<robot name="two" xmlns:x="http://x">"#,
    )
    .replace(
        r#"<origin xyz="0 0 0.5""#,
        r#"<origin x:xyz="nan" xyz="0 0 0.5""#,
    )
    .replace(
        r#"<axis xyz="0 1 0"/>"#,
        r#"<x:axis xyz="0 0 0"/><x:origin xyz="?"/>"#,
    )
    .replace(
        r#"<link name="base"/>"#,
        r#"<link name="base"/><x:link name="base"/>"#,
    );
    let robot = parse(&text).unwrap();
    let shoulder = &robot.model().joints()[0];
    assert_eq!(
        shoulder.parent_from_joint.translation.to_array(),
        [0.0, 0.0, 0.5]
    );
    assert_eq!(shoulder.axis.to_array(), [1.0, 0.0, 0.0]);
    assert_eq!(robot.model().frames().len(), 3);
}

#[test]
fn later_versions_are_validated() {
    let later = |from: &str, to: &str| {
        damaged(from, to).replace(r#"name="two""#, r#"name="two" version="1.2""#)
    };
    let both = later(r#"rpy="0 0.1 0""#, r#"rpy="0 0 0" quat_xyzw="0 0 0 1""#);
    assert_eq!(
        parse(&both).unwrap_err().to_string(),
        "two.urdf:7: joint `shoulder`, <origin>: attribute `quat_xyzw` and `rpy` are both given"
    );
    let zero = later(r#"rpy="0 0.1 0""#, r#"quat_xyzw="0 0 0 0""#);
    assert_eq!(
        parse(&zero).unwrap_err().to_string(),
        "two.urdf:7: joint `shoulder`, <origin>: attribute `quat_xyzw` is zero and no rotation"
    );
    assert!(parse(&later(r#"rpy="0 0.1 0""#, r#"quat_xyzw="0 0 0 2""#)).is_ok());
}

#[test]
fn deep_nesting_does_not_crash() {
    let (open, close) = ("<a>".repeat(100_000), "</a>".repeat(100_000));
    for text in [
        damaged(
            r#"<link name="upper"/>"#,
            &format!(r#"<link name="upper">{open}{close}</link>"#),
        ),
        damaged(
            r#"<link name="upper"/>"#,
            &format!(r#"<link name="upper"/>{open}{close}"#),
        ),
        damaged(
            r#"<axis xyz="0 1 0"/>"#,
            &format!(r#"<axis xyz="0 1 0">{open}{close}</axis>"#),
        ),
    ] {
        // Accepted or rejected by the XML parser, but no crash.
        if let Ok(robot) = parse(&text) {
            assert_eq!(robot.model().degrees_of_freedom(), 2);
        }
    }
}
