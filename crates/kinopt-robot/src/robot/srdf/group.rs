//! `<group>`: named sets of joints.

use std::collections::{BTreeSet, HashMap};

use crate::robot::Robot;
use crate::robot::xml::{Element, ParseIssue, Read, RepairKind, is};
use kinopt_kinematics::model::{JointId, UnknownName};

/// A named set of joints.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Group {
    /// Name of the group.
    pub name: String,
    /// The moving joints of the group's joints, links, chains and groups; parents before children.
    pub joints: Vec<JointId>,
}

/// A group whose subgroups are unresolved names.
struct GroupMembers {
    joints: BTreeSet<JointId>,
    groups: Vec<String>,
}

/// Reads all groups of a document.
pub(super) fn read_all(
    elements: &[Element<'_>],
    robot: &Robot,
    virtual_joints: &[&str],
) -> Read<Vec<Group>> {
    let mut names: Vec<String> = Vec::new();
    let mut members: HashMap<String, GroupMembers> = HashMap::new();
    let mut named_elements = Vec::new();
    for element in elements {
        let Some(name) = element.reading.leniently(element.name("name"))? else {
            continue;
        };
        if members.contains_key(&name) {
            let fault = ParseIssue::RepeatedGroup { group: name };
            element.repair_or_fail(fault, |_| RepairKind::FirstCounts { child: "group" })?;
            continue;
        }
        members.insert(name.clone(), read(element, robot, virtual_joints)?);
        names.push(name);
        named_elements.push(element);
    }
    let mut groups = Vec::with_capacity(names.len());
    for (element, name) in named_elements.into_iter().zip(&names) {
        // Visit every subgroup once; a subgroup that contains the group itself is a cycle.
        let mut joints = BTreeSet::new();
        let mut visited = BTreeSet::new();
        let mut pending: Vec<&String> = vec![name];
        while let Some(inner) = pending.pop() {
            let Some(group_members) = members.get(inner) else {
                let valid = names.iter().map(String::as_str);
                let unknown = UnknownName::new("group", inner, valid);
                element.repair_or_fail(unknown.into(), RepairKind::LeftOut)?;
                continue;
            };
            joints.extend(&group_members.joints);
            if group_members.groups.contains(name) {
                let group = name.clone();
                element
                    .repair_or_fail(ParseIssue::GroupWithinItself { group }, RepairKind::LeftOut)?;
                visited.insert(name.as_str());
            }
            let new = group_members
                .groups
                .iter()
                .filter(|group| visited.insert(group.as_str()));
            pending.extend(new);
        }
        groups.push(Group {
            name: name.clone(),
            joints: joints.into_iter().collect(),
        });
    }
    Ok(groups)
}

fn read(group: &Element<'_>, robot: &Robot, virtual_joints: &[&str]) -> Read<GroupMembers> {
    let model = robot.model();
    let mut joints = BTreeSet::new();
    let mut groups = Vec::new();
    for node in group.node.children().filter(|node| node.is_element()) {
        let part = group.part(node);
        let unknown = |error: UnknownName| part.fault(error.into());
        let mut read_member = || -> Read<()> {
            if is(node, "joint") {
                let name = part.name("name")?;
                if !virtual_joints.contains(&name.as_str()) {
                    let joint = model.joint(&name).map_err(unknown)?;
                    joints.extend(model.coordinate(joint).map(|_| joint));
                }
            } else if is(node, "link") {
                let frame = model.frame(&part.name("name")?).map_err(unknown)?;
                let joint = model.frames()[frame.index()].joint;
                joints.extend(joint.filter(|joint| model.coordinate(*joint).is_some()));
            } else if is(node, "chain") {
                let (base, tip) = (part.name("base_link")?, part.name("tip_link")?);
                joints.extend(robot.chain(base.as_str(), tip.as_str()).map_err(unknown)?);
            } else if is(node, "group") {
                groups.push(part.name("name")?);
            }
            Ok(())
        };
        group.reading.leniently(read_member())?;
    }
    Ok(GroupMembers { joints, groups })
}
