//! Promise: a modified SRDF file is an error that names the fault and its location, or valid groups, states and passive
//! joints of its robot. Never a panic.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::BTreeMap;

use kinopt::robot::{BaseJoint, ParseIssue, Robot, RobotFileError, Srdf};
use support::changed_xml::Element;
use support::random::{Random, case_count};

/// A leg with a ball joint, a mimic joint and a free base.
const LEG: &str = r#"<robot name="leg"><link name="pelvis"/><link name="thigh"/><link name="shin"/><link name="foot"/><link name="toe"/>
<joint name="hip" type="spherical"><parent link="pelvis"/><child link="thigh"/></joint>
<joint name="knee" type="revolute"><parent link="thigh"/><child link="shin"/><axis xyz="0 1 0"/><limit lower="0" upper="2.5"/></joint>
<joint name="ankle" type="revolute"><parent link="shin"/><child link="foot"/><axis xyz="0 1 0"/><limit lower="-1" upper="1"/></joint>
<joint name="toe" type="revolute"><parent link="foot"/><child link="toe"/><axis xyz="0 1 0"/><limit lower="-1" upper="1"/><mimic joint="ankle" multiplier="0.5"/></joint></robot>"#;

const SRDF: &str = r#"<robot name="leg">
<virtual_joint name="float" type="floating" parent_frame="world" child_link="pelvis"/>
<group name="leg"><chain base_link="pelvis" tip_link="toe"/></group>
<group name="shank"><joint name="knee"/><link name="foot"/></group>
<group name="all"><group name="leg"/><group name="shank"/><joint name="root_joint/x"/></group>
<group_state name="crouch" group="leg"><joint name="knee" value="1.5"/><joint name="hip" value="0.1 0 0 0.9"/></group_state>
<group_state name="apart" group="all"><joint name="root_joint" value="1 2 3 0 0 0.6 0.8"/><joint name="ankle" value="0.25"/></group_state>
<end_effector name="sole" group="shank" parent_link="foot" parent_group="leg"/>
<passive_joint name="toe"/><passive_joint name="ankle"/>
<disable_collisions link1="thigh" link2="shin" reason="Adjacent"/>
</robot>"#;

fn check(srdf: &Srdf, robot: &Robot) {
    let model = robot.model();
    let q = model.neutral();
    for group in &srdf.groups {
        let mut joints = group.joints.clone();
        joints.sort_unstable();
        joints.dedup();
        assert_eq!(joints.len(), group.joints.len(), "{}", group.name);
        assert!(
            joints.iter().all(|id| model.coordinate(*id).is_some()),
            "{}",
            group.name
        );
        match srdf.only(robot, &group.name, &q).unwrap().build() {
            Ok(map) => assert!(map.variables() <= model.degrees_of_freedom()),
            Err(error) => assert!(error.to_string().contains('`'), "{error}"),
        }
    }
    for state in &srdf.states {
        assert!(srdf.group(&state.group).is_ok());
        let there = srdf.state(&state.name, &q).unwrap();
        assert_eq!(there.len(), q.len());
        // A quaternion may have any length in the file; the state's is a rotation.
        let mut unit = there.clone();
        model.normalise(&mut unit).unwrap();
        assert!(there.iter().chain(&unit).all(|value| value.is_finite()));
    }
    for pair in &srdf.disabled_pairs {
        assert!(
            pair.links
                .iter()
                .all(|link| link.index() < model.frames().len())
        );
    }
    match srdf.driven(robot, &q).build() {
        Ok(map) => assert!(map.variables() <= robot.map().variables()),
        Err(error) => assert!(error.to_string().contains('`'), "{error}"),
    }
    let passive = robot
        .clone()
        .with_passive_joints(srdf.passive_joints.iter().copied());
    assert_eq!(passive.unwrap().passive_joints(), srdf.passive_joints);
}

#[test]
fn modified_file_is_an_error_or_fits_the_robot() {
    let robot = Robot::parse(LEG, "leg.urdf").unwrap();
    let robot = robot.with_base_joint(BaseJoint::FREE).unwrap();
    let root = Element::parse(SRDF);
    check(
        &Srdf::parse(&root.text(), "leg.srdf", &robot).unwrap(),
        &robot,
    );
    let copies = case_count(8000, 2500) as u64;
    let mut outcomes: BTreeMap<String, u64> = BTreeMap::new();
    for copy in 0..copies {
        let mut random = Random::new(copy);
        let mut changed = root.clone();
        for _ in 0..=random.below(3) {
            changed.change(&mut random);
        }
        let text = changed.text();
        let lenient = Srdf::reader().lenient();
        let mended = lenient.parse(&text, "changed.srdf", &robot);
        let outcome = match Srdf::parse(&text, "changed.srdf", &robot) {
            Ok(srdf) => {
                check(&srdf, &robot);
                assert_eq!(mended.unwrap(), srdf);
                "read".to_owned()
            }
            Err(error) => {
                let message = error.to_string();
                assert!(message.starts_with("changed.srdf"), "{message}");
                let RobotFileError::Element { line, fault, .. } = error else {
                    panic!("{message}")
                };
                assert!(
                    line > 0 && line as usize <= text.lines().count(),
                    "{message}"
                );
                // The lenient reader omits and lists any fault, except for a root that is not `robot`.
                match mended {
                    Ok(srdf) => {
                        check(&srdf, &robot);
                        assert!(!srdf.repairs.is_empty());
                    }
                    Err(error) => assert_eq!(fault, ParseIssue::NotARobot, "{error}"),
                }
                let reported = format!("{fault:?}");
                reported.split([' ', '(']).next().unwrap().to_owned()
            }
        };
        *outcomes.entry(outcome).or_default() += 1;
    }
    let read = outcomes["read"];
    assert!(6 * read > copies && read < copies, "{outcomes:?}");
    assert!(outcomes.len() > 6, "{outcomes:?}");
}
