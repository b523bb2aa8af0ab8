//! Order of the joints of a document, parents first, and checks that they form a tree.

use std::collections::HashMap;
use std::collections::VecDeque;

use super::document::Document;
use super::joint_element::{JointElement, MimicElement};
use crate::robot::xml::{Named, ParseIssue, Read, Reading, RobotFileError};
use kinopt_kinematics::model::UnknownName;

/// A joint and the links that it connects, as indices into the document's lists.
#[derive(Clone, Copy, Debug)]
pub(super) struct JointEdge {
    pub(super) joint: usize,
    pub(super) parent_link: usize,
    pub(super) child_link: usize,
}

/// A tree of links: every joint comes after the joint that carries its parent link.
#[derive(Clone, Debug)]
pub(super) struct Topology {
    pub(super) branches: Vec<JointEdge>,
    /// Index of the source joint of every joint, in document order.
    pub(super) sources: Vec<Option<usize>>,
}

/// Finds the tree that the links and joints of a document form.
pub(super) fn order(reading: &Reading<'_>, document: &Document) -> Read<Topology> {
    let Document { links, joints, .. } = document;
    if links.is_empty() {
        return Err(reading.fault(document.robot.offset, "<robot>".into(), ParseIssue::NoLinks));
    }
    let link_by_name = index(reading, "link", links.iter().map(|link| &link.named))?;
    let joint_by_name = index(reading, "joint", joints.iter().map(|joint| &joint.named))?;

    let mut carrier: Vec<Option<usize>> = vec![None; links.len()];
    let mut child_branches: Vec<Vec<JointEdge>> = vec![Vec::new(); links.len()];
    let mut sources = Vec::with_capacity(joints.len());
    let link_names = links.iter().map(|link| link.named.name.as_str());
    let joint_names = joints.iter().map(|joint| joint.named.name.as_str());
    for (index, joint) in joints.iter().enumerate() {
        let unknown = |unknown: UnknownName| joint_fault(reading, joint, unknown.into());
        let link = |name: &str| {
            let names = || UnknownName::new("link", name, link_names.clone());
            link_by_name
                .get(name)
                .copied()
                .ok_or_else(|| unknown(names()))
        };
        let branch = JointEdge {
            joint: index,
            parent_link: link(&joint.parent)?,
            child_link: link(&joint.child)?,
        };
        if let Some(other) = carrier[branch.child_link] {
            let fault = ParseIssue::TwoParents {
                link: joint.child.clone(),
                other: joints[other].named.name.clone(),
            };
            return Err(joint_fault(reading, joint, fault));
        }
        carrier[branch.child_link] = Some(index);
        child_branches[branch.parent_link].push(branch);
        let source = joint.mimic.as_ref().map(|MimicElement { source, .. }| {
            let names = || UnknownName::new("joint", source, joint_names.clone());
            let source_index = joint_by_name.get(source.as_str()).copied();
            source_index.ok_or_else(|| unknown(names()))
        });
        sources.push(source.transpose()?);
    }

    let roots: Vec<usize> = (0..links.len()).filter(|&l| carrier[l].is_none()).collect();
    if roots.len() > 1 {
        let names = roots.iter().map(|&root| links[root].named.name.clone());
        let fault = ParseIssue::SeveralRoots {
            roots: names.collect(),
        };
        return Err(reading.fault(document.robot.offset, "<robot>".into(), fault));
    }
    let mut branches = Vec::with_capacity(joints.len());
    let mut pending: VecDeque<usize> = roots.into();
    while let Some(link) = pending.pop_front() {
        for branch in &child_branches[link] {
            branches.push(*branch);
            pending.push_back(branch.child_link);
        }
    }
    // Every link has at most one parent, so an unreachable link descends from a cycle.
    let mut reached = vec![false; joints.len()];
    for branch in &branches {
        reached[branch.joint] = true;
    }
    match reached.iter().position(|&reached| !reached) {
        Some(outside) => {
            let cycle_joint = joint_on_cycle(outside, joints, &link_by_name, &carrier);
            Err(joint_fault(
                reading,
                &joints[cycle_joint],
                ParseIssue::Cycle,
            ))
        }
        None => Ok(Topology { branches, sources }),
    }
}

/// A joint of the cycle from which a joint descends: n steps towards the root end in it, for n joints.
fn joint_on_cycle(
    joint: usize,
    joints: &[JointElement],
    link_by_name: &HashMap<&str, usize>,
    carrier: &[Option<usize>],
) -> usize {
    let mut current = joint;
    for _ in joints {
        let parent = link_by_name.get(joints[current].parent.as_str());
        current = parent.and_then(|&link| carrier[link]).unwrap_or(current);
    }
    current
}

fn index<'a>(
    reading: &Reading<'_>,
    kind: &str,
    elements: impl Iterator<Item = &'a Named>,
) -> Read<HashMap<&'a str, usize>> {
    let mut by_name = HashMap::new();
    let mut offsets = Vec::new();
    for (position, element) in elements.enumerate() {
        offsets.push(element.offset);
        if let Some(first) = by_name.insert(element.name.as_str(), position) {
            let first_line = reading.line(offsets[first]);
            let label = format!("{kind} `{}`", element.name);
            return Err(reading.fault(
                element.offset,
                label,
                ParseIssue::DuplicateName { first_line },
            ));
        }
    }
    Ok(by_name)
}

fn joint_fault(reading: &Reading<'_>, joint: &JointElement, fault: ParseIssue) -> RobotFileError {
    let label = format!("joint `{}`", joint.named.name);
    reading.fault(joint.named.offset, label, fault)
}
