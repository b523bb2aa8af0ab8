//! Promise: a group consists of its joints and of those of its links, chains and groups. States are configurations. A
//! map of the driven joints holds the passive joints fixed; a map of a group holds all others fixed.

use kinopt::robot::{BaseJoint, Robot, Srdf};
use support::fault_tables::ExpectedError;

const PANDA: &str = r#"<?xml version="1.0"?>
<robot name="franka_panda">
  <virtual_joint name="stand" type="fixed" parent_frame="world" child_link="base"/>
  <group name="arm"><chain base_link="base" tip_link="link7"/></group>
  <group name="wrist"><joint name="joint6"/><joint name="joint7"/><joint name="flange_mount"/><joint name="stand"/></group>
  <group name="hand"><link name="finger_left"/><link name="finger_right"/></group>
  <group name="mounted"><link name="flange"/><link name="link2"/></group>
  <group name="all"><group name="both"/><joint name="joint1"/></group>
  <group name="both"><group name="arm"/><group name="hand"/></group>
  <group_state name="ready" group="arm"><joint name="joint2" value="-0.5"/><joint name="root_joint" value="1 2 3 0 0 0.6 0.8"/>
    <joint name="joint4" value=" -2.0 "/><joint name="flange_mount" value="0"/><joint name="stand" value="0"/></group_state>
  <end_effector name="gripper" parent_link="flange" group="hand" parent_group="arm"/>
  <passive_joint name="joint7"/><passive_joint name="finger_right_slide"/>
  <passive_joint name="stand"/><passive_joint name="flange_mount"/>
  <disable_collisions link1="link1" link2="link2" reason="Adjacent"/>
  <link_sphere_approximation link="link1"/>
</robot>"#;

fn panda() -> Robot {
    Robot::read(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../models/franka_panda.urdf"
    ))
    .unwrap()
}

#[test]
fn groups_combine_joints_links_chains_and_groups() {
    let robot = panda();
    let srdf = Srdf::parse(PANDA, "panda.srdf", &robot).unwrap();
    let names = |group: &str| -> Vec<&str> {
        let joints = srdf.group(group).unwrap().joints.iter();
        joints
            .map(|id| robot.model().joints()[id.index()].name.as_str())
            .collect()
    };
    let arm = [
        "joint1", "joint2", "joint3", "joint4", "joint5", "joint6", "joint7",
    ];
    assert_eq!(names("arm"), arm);
    assert_eq!(names("wrist"), ["joint6", "joint7"]);
    assert_eq!(names("hand"), ["finger_left_slide", "finger_right_slide"]);
    assert_eq!(
        names("both"),
        [&arm[..], &["finger_left_slide", "finger_right_slide"]].concat()
    );
    assert_eq!(names("all"), names("both"));
    // The joint of a fixed link is not included.
    assert_eq!(names("mounted"), ["joint2"]);
    srdf.group("leg").says("wrist");
    let [end] = &srdf.end_effectors[..] else {
        unreachable!()
    };
    assert_eq!(
        (end.group.as_str(), end.parent_group.as_deref()),
        ("hand", Some("arm"))
    );
    let [pair] = &srdf.disabled_pairs[..] else {
        unreachable!()
    };
    let links = pair
        .links
        .map(|id| robot.model().frames()[id.index()].name.as_str());
    assert_eq!(
        (links, pair.reason.as_str()),
        (["link1", "link2"], "Adjacent")
    );
    assert_eq!(srdf.virtual_joints[0].kind, "fixed");
    // Only moving joints: neither a virtual nor a fixed joint has a value.
    let passive = srdf.passive_joints.iter();
    let passive = passive.map(|id| robot.model().joints()[id.index()].name.as_str());
    assert_eq!(
        passive.collect::<Vec<_>>(),
        ["joint7", "finger_right_slide"]
    );
}

#[test]
fn maps_fix_passive_joints_and_other_groups() {
    let robot = panda();
    let srdf = Srdf::parse(PANDA, "panda.srdf", &robot).unwrap();
    let q = robot.model().random_configuration(3);
    // Seven joints and one finger; the other finger mimics it and is no variable.
    let driven = srdf.driven(&robot, &q).build().unwrap();
    assert_eq!(driven.variables(), 7);
    let mut expanded = vec![0.0; 9];
    driven.expand(&[0.01; 7], &mut expanded).unwrap();
    assert_eq!(expanded[6], q[6]);
    // Passive, but it mimics the first finger.
    assert_eq!(expanded[7..], [0.01; 2]);
    let wrist = srdf.only(&robot, "wrist", &q).unwrap().build().unwrap();
    assert_eq!(wrist.variables(), 2);
    wrist.expand(&[0.25, 0.5], &mut expanded).unwrap();
    assert_eq!(expanded[..7], [&q[..5], &[0.25, 0.5]].concat());
    // One finger is the source joint, the other mimics it.
    let hand = srdf.only(&robot, "hand", &q).unwrap().build().unwrap();
    assert_eq!(hand.variables(), 1);
    hand.expand(&[0.02], &mut expanded).unwrap();
    assert_eq!(expanded, [&q[..7], &[0.02; 2]].concat());
    assert!(srdf.only(&robot, "leg", &q).is_err());
    assert!(srdf.driven(&robot, &q[..3]).build().is_err());
}

/// A joint that mimics one outside of its group keeps the value of its source joint and is no variable.
#[test]
fn mimic_joints_follow_sources_outside_the_group() {
    let joint = |k: usize, more: &str| {
        format!(
            r#"<link name="l{k}"/><joint name="j{k}" type="revolute"><parent link="l{}"/><child link="l{k}"/><axis xyz="0 0 1"/>
            <limit lower="-1" upper="1" effort="1" velocity="1"/>{more}</joint>"#,
            k - 1
        )
    };
    let text = format!(
        r#"<robot name="hand"><link name="l0"/>{}{}{}{}</robot>"#,
        joint(1, ""),
        joint(2, r#"<mimic joint="j1"/>"#),
        joint(3, r#"<mimic joint="j1" multiplier="-0.5"/>"#),
        joint(4, "")
    );
    let robot = Robot::parse(&text, "hand.urdf").unwrap();
    let srdf = r#"<robot name="hand"><group name="thumb"><joint name="j1"/><joint name="j2"/></group>
        <group name="rest"><joint name="j3"/><joint name="j4"/></group></robot>"#;
    let srdf = Srdf::parse(srdf, "hand.srdf", &robot).unwrap();
    let q = [0.2, 0.2, -0.1, 0.6];
    for (group, moved) in [
        ("thumb", [0.4, 0.4, -0.2, 0.6]),
        ("rest", [0.2, 0.2, -0.1, 0.4]),
    ] {
        let map = srdf.only(&robot, group, &q).unwrap().build().unwrap();
        assert_eq!(map.variables(), 1, "{group}");
        let mut expanded = q;
        map.expand(&[0.4], &mut expanded).unwrap();
        assert_eq!(expanded, moved, "{group}");
    }
}

#[test]
fn states_are_configurations_with_free_base_too() {
    let robot = panda();
    let q = robot.model().neutral();
    let srdf = Srdf::parse(PANDA, "panda.srdf", &robot).unwrap();
    let ready = srdf.state("ready", &q).unwrap();
    let changed: Vec<(usize, f64)> = (0..9)
        .filter(|&at| ready[at] != q[at])
        .map(|at| (at, ready[at]))
        .collect();
    assert_eq!(changed, [(1, -0.5), (3, -2.0)]);
    srdf.state("steady", &q).says("ready");

    let robot = panda().with_base_joint(BaseJoint::FREE).unwrap();
    let srdf = Srdf::parse(PANDA, "panda.srdf", &robot).unwrap();
    let ready = srdf.state("ready", &robot.model().neutral()).unwrap();
    // The file's quaternion has the order x, y, z, w.
    assert_eq!(ready[..7], [1.0, 2.0, 3.0, 0.8, 0.0, 0.0, 0.6]);
    assert_eq!(ready[8], -0.5);
}

/// The state `home` of arm and hand is that of both where each group has a `home`.
#[test]
fn state_of_several_groups_combines_or_selects_one() {
    let robot = panda();
    let more = r#"<group_state name="home" group="arm"><joint name="joint2" value="0.3"/><joint name="joint4" value="-1"/></group_state>
        <group_state name="home" group="hand"><joint name="finger_left_slide" value="0.02"/></group_state></robot>"#;
    let srdf = Srdf::parse(&PANDA.replace("</robot>", more), "panda.srdf", &robot).unwrap();
    let q = robot.model().neutral();
    let of = |name: &str| srdf.state(name, &q).map(|home| [home[1], home[3], home[7]]);
    assert_eq!(of("home").unwrap(), [0.3, -1.0, 0.02]);
    assert_eq!(of("arm/home").unwrap(), [0.3, -1.0, q[7]]);
    assert_eq!(of("hand/home").unwrap(), [q[1], q[3], 0.02]);
    for unknown in ["leg/home", "/home", "armhome", "hand/ready"] {
        let message = of(unknown).unwrap_err().to_string();
        assert!(
            message.contains(unknown) && message.contains("ready, home"),
            "{message}"
        );
    }
}

/// A byte order mark and an empty parent group are ignored.
#[test]
fn byte_order_mark_and_empty_parent_are_ignored() {
    let robot = panda();
    let plain = Srdf::parse(PANDA, "panda.srdf", &robot).unwrap();
    let marked = Srdf::parse(&format!("\u{feff}{PANDA}"), "panda.srdf", &robot).unwrap();
    assert_eq!(marked.groups.len(), plain.groups.len());
    assert_eq!(marked.disabled_pairs, plain.disabled_pairs);
    let text = PANDA.replace(r#"parent_group="arm""#, r#"parent_group="""#);
    let empty = Srdf::parse(&text, "panda.srdf", &robot).unwrap();
    assert_eq!(empty.end_effectors[0].parent_group, None);
    let text = PANDA.replace(r#"parent_group="arm""#, r#"parent_group="leg""#);
    Srdf::parse(&text, "panda.srdf", &robot).says("leg");
}
