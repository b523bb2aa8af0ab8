//! From a document to what it says of a robot.

use std::path::Path;

use roxmltree::Node;

use super::{DisabledPair, EndEffector, Srdf, VirtualJoint, group, state};
use crate::file::{Place, ReadError, read_bytes};
use crate::model::{FrameId, UnknownName};
use crate::robot::Robot;
use crate::robot::xml::{Element, Fault, Reading, RobotFileError, is, parse as parse_xml};

/// The longest file that is read; real ones stay below 1 MB.
const LENGTH_LIMIT: u64 = 64 << 20;

pub(super) fn read(path: &Path, robot: &Robot) -> Result<Srdf, RobotFileError> {
    let file = path.display().to_string();
    let bytes = read_bytes(path, LENGTH_LIMIT)?;
    let text = std::str::from_utf8(&bytes).map_err(|error| {
        let at = Place::Byte(error.valid_up_to());
        ReadError::malformed(&file, at, "is not UTF-8 text")
    })?;
    parse(text, &file, robot)
}

pub(super) fn parse(text: &str, file: &str, robot: &Robot) -> Result<Srdf, RobotFileError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let reading = Reading {
        file,
        text,
        lenient: false,
        repairs: Vec::new().into(),
    };
    let document = parse_xml(file, text)?;
    let root = document.root_element();
    if !root.has_tag_name("robot") {
        let label = format!("<{}>", root.tag_name().name());
        return Err(Element::new(&reading, root, label).fault(Fault::NotARobot));
    }
    let elements = |tag: &'static str| -> Vec<Element<'_>> {
        let nodes = root.children().filter(move |node| is(*node, tag));
        nodes.map(|node| labelled(&reading, node, tag)).collect()
    };
    let virtual_elements = elements("virtual_joint");
    let mut virtual_joints = Vec::new();
    for element in &virtual_elements {
        virtual_joints.push(VirtualJoint {
            name: element.name("name")?,
            kind: element.name("type")?,
            parent_frame: element.name("parent_frame")?,
            child_link: link(element, "child_link", robot)?,
        });
    }
    let virtual_names: Vec<&str> = virtual_joints.iter().map(|it| it.name.as_str()).collect();
    let groups = group::read_all(&elements("group"), robot, &virtual_names)?;
    let names: Vec<&str> = groups.iter().map(|group| group.name.as_str()).collect();
    let known = |element: &Element<'_>, group: String| match names.contains(&group.as_str()) {
        true => Ok(group),
        false => {
            let unknown = UnknownName::new("group", &group, names.iter().copied());
            Err(element.fault(unknown.into()))
        }
    };
    let states = elements("group_state");
    let states = states
        .iter()
        .map(|element| state::read(element, robot, &names, &virtual_names));
    let end_effectors = elements("end_effector");
    let end_effectors = end_effectors.iter().map(|element| {
        let parent_group = element
            .text("parent_group")
            .filter(|group| !group.is_empty());
        Ok(EndEffector {
            name: element.name("name")?,
            group: known(element, element.name("group")?)?,
            parent_link: link(element, "parent_link", robot)?,
            parent_group: parent_group
                .map(|group| known(element, group.to_owned()))
                .transpose()?,
        })
    });
    let mut passive_joints = Vec::new();
    for element in elements("passive_joint") {
        let name = element.name("name")?;
        if virtual_names.contains(&name.as_str()) {
            continue;
        }
        let unknown = |error: UnknownName| element.fault(error.into());
        let joint = robot.model().joint(&name).map_err(unknown)?;
        passive_joints.extend(robot.model().coordinate(joint).map(|_| joint));
    }
    let pairs = elements("disable_collisions");
    let pairs = pairs.iter().map(|element| {
        let links = [
            link(element, "link1", robot)?,
            link(element, "link2", robot)?,
        ];
        let reason = element.text("reason").unwrap_or_default().to_owned();
        Ok(DisabledPair { links, reason })
    });
    Ok(Srdf {
        states: states.collect::<Result<_, _>>()?,
        end_effectors: end_effectors.collect::<Result<_, RobotFileError>>()?,
        passive_joints,
        disabled_pairs: pairs.collect::<Result<_, RobotFileError>>()?,
        groups,
        virtual_joints,
    })
}

fn labelled<'a>(reading: &'a Reading<'a>, node: Node<'a, 'a>, tag: &str) -> Element<'a> {
    let label = match node.attribute("name") {
        Some(name) => format!("{tag} `{name}`"),
        None => format!("<{tag}>"),
    };
    Element::new(reading, node, label)
}

fn link(
    element: &Element<'_>,
    attribute: &'static str,
    robot: &Robot,
) -> Result<FrameId, RobotFileError> {
    let name = element.name(attribute)?;
    let unknown = |error: UnknownName| element.fault(error.into());
    robot.model().frame(&name).map_err(unknown)
}
