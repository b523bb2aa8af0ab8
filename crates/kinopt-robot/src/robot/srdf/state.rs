//! `<group_state>`: named joint values.

use std::collections::BTreeSet;

use super::Srdf;
use crate::robot::Robot;
use crate::robot::xml::{Element, ParseIssue, Read, RepairKind, is};
use kinopt_kinematics::model::{JointId, JointKind, Model, UnknownName};

/// Pinocchio's name of the joint that moves a whole robot.
const BASE_JOINT_NAME: &str = "root_joint";

/// A group state: named values of some joints.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct GroupState {
    /// Name of the state. States of other groups may have the same name.
    pub name: String,
    /// Group to which the state belongs.
    pub group: String,
    /// Configuration indices and their values: radians, metres, or components of unit quaternions.
    pub values: Vec<(usize, f64)>,
}

impl Srdf {
    /// A configuration with the values of a state; all other values are those of `q`.
    ///
    /// If several groups have a state of this name, all are applied in the order of the file: for example `home` of an
    /// arm and of its hand. `hand/home` selects the state of one group. Mimic joints are not updated.
    ///
    /// # Errors
    /// An unknown state. The error lists the valid ones.
    pub fn state(&self, name: &str, q: &[f64]) -> Result<Vec<f64>, UnknownName> {
        let is_requested = |state: &&GroupState| {
            let group_prefix = name.strip_suffix(state.name.as_str());
            group_prefix.is_some_and(|group| {
                group.is_empty() || group.strip_suffix('/') == Some(&*state.group)
            })
        };
        let mut states = self.states.iter().filter(is_requested).peekable();
        if states.peek().is_none() {
            let mut listed = BTreeSet::new();
            let names = self.states.iter().map(|state| state.name.as_str());
            let names = names.filter(|name| listed.insert(*name));
            return Err(UnknownName::new("group state", name, names));
        }
        let mut configuration = q.to_vec();
        for &(coordinate, value) in states.flat_map(|state| &state.values) {
            if let Some(slot) = configuration.get_mut(coordinate) {
                *slot = value;
            }
        }
        Ok(configuration)
    }
}

pub(super) fn read(
    element: &Element<'_>,
    robot: &Robot,
    groups: &[&str],
    virtual_joints: &[&str],
) -> Read<GroupState> {
    let (name, group) = (element.name("name")?, element.name("group")?);
    if !groups.contains(&group.as_str()) {
        let unknown = UnknownName::new("group", &group, groups.iter().copied());
        return Err(element.fault(unknown.into()));
    }
    let mut values = Vec::new();
    for node in element.node.children().filter(|node| is(*node, "joint")) {
        let part = element.part(node);
        let Some(name) = part.reading.leniently(part.name("name"))? else {
            continue;
        };
        let Some(coordinates) = coordinates(robot.model(), &name) else {
            // A robot without a base joint ignores the pose of its base.
            if name == BASE_JOINT_NAME || virtual_joints.contains(&name.as_str()) {
                continue;
            }
            // Fixed joints have no value, so their values are ignored without a note.
            if let Err(unknown) = robot.model().joint(&name) {
                part.repair_or_fail(unknown.into(), RepairKind::LeftOut)?;
            }
            continue;
        };
        let numbers = part.reading.leniently(numbers(&part, coordinates.len()))?;
        values.extend(coordinates.into_iter().zip(numbers.into_iter().flatten()));
    }
    Ok(GroupState {
        name,
        group,
        values,
    })
}

/// The coordinates of a moving joint in the order of its values in a file. SRDF writes quaternions as x, y, z, w.
fn coordinates(model: &Model, name: &str) -> Option<Vec<usize>> {
    let kind_and_coordinate = |name: &str| -> Option<(JointKind, usize)> {
        let joint: JointId = model.joint(name).ok()?;
        let kind = model.joints()[joint.index()].kind;
        Some((kind, model.coordinate(joint)?))
    };
    let ball = |first: usize| [first + 1, first + 2, first + 3, first];
    if let Some((kind, first)) = kind_and_coordinate(name) {
        return Some(match kind {
            JointKind::Ball => ball(first).to_vec(),
            _ => vec![first],
        });
    }
    // A free or planar joint is a chain of joints.
    let part = |part: &str| kind_and_coordinate(&format!("{name}/{part}")).map(|(_, first)| first);
    let (x, y) = (part("x")?, part("y")?);
    match (part("z"), part("rotation"), part("yaw")) {
        (Some(z), Some(rotation), _) => Some([&[x, y, z][..], &ball(rotation)].concat()),
        (_, _, Some(yaw)) => Some(vec![x, y, yaw]),
        _ => None,
    }
}

fn numbers(part: &Element<'_>, count: usize) -> Read<Vec<f64>> {
    let attribute = "value";
    let text = part.name(attribute)?;
    let words = text.split_whitespace();
    let numbers = words.map(|word| word.parse().ok().filter(|number: &f64| number.is_finite()));
    let numbers: Option<Vec<f64>> = numbers.collect();
    // The quaternion in four or seven numbers must not be zero.
    let has_rotation = |numbers: &[f64]| match count {
        4 | 7 => numbers[count - 4..].iter().any(|part| *part != 0.0),
        _ => true,
    };
    match numbers {
        Some(numbers) if numbers.len() == count && has_rotation(&numbers) => Ok(numbers),
        Some(numbers) if numbers.len() == count => {
            Err(part.fault(ParseIssue::ZeroLength { attribute }))
        }
        _ => Err(part.fault(ParseIssue::BadNumbers {
            attribute,
            count,
            text,
        })),
    }
}
