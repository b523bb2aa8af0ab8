//! A URDF document: links and joints that are valid one by one.

use std::collections::HashSet;

use roxmltree::Node;

use super::joint_element::{self, JointElement, READ_ELEMENTS};
use super::link_element;
use super::version::Version;
use crate::robot::Link;
use crate::robot::xml::{
    Element, Named, ParseIssue, Read, Reading, RepairKind, RobotFileError, is, parse,
};

/// Link at the world frame, which Drake's files need not declare.
const WORLD: &str = "world";
/// Directives of xacro; any other element of its namespace is a macro call.
const DIRECTIVES: [&str; 12] = [
    "arg",
    "attribute",
    "call",
    "element",
    "elif",
    "else",
    "if",
    "include",
    "insert_block",
    "macro",
    "property",
    "unless",
];
/// Name that a lenient reader gives a robot without a name.
const DEFAULT_NAME: &str = "robot";

/// A document whose elements are valid one by one.
#[derive(Clone, Debug)]
pub(super) struct Document {
    pub(super) robot: Named,
    pub(super) links: Vec<LinkElement>,
    pub(super) joints: Vec<JointElement>,
}

/// A link with its name.
#[derive(Clone, Debug)]
pub(super) struct LinkElement {
    pub(super) named: Named,
    pub(super) link: Link,
}

/// Reads every link and joint independently of the others.
pub(super) fn read(reading: &Reading<'_>) -> Read<Document> {
    let xml = parse(reading.file, reading.text)?;
    let root = xml.root_element();
    check_macros(reading, root)?;
    if !root.has_tag_name("robot") {
        let label = format!("<{}>", root.tag_name().name());
        return Err(Element::new(reading, root, label).fault(ParseIssue::NotARobot));
    }
    let robot = Element::new(reading, root, "<robot>".to_owned());
    let version = Version::of(&robot);

    let mut document = Document {
        robot: name_of(&robot)?,
        links: Vec::new(),
        joints: Vec::new(),
    };
    for node in root.children().filter(Node::is_element) {
        if is(node, "link") {
            let named = Element::new(reading, node, "<link>".to_owned()).named()?;
            let link = link_element::read(reading, node, &named.name, version);
            document.links.push(LinkElement { named, link });
        } else if is(node, "joint") {
            let joint = joint_element::read(reading, node, version)?;
            document.joints.push(joint);
        } else {
            robot.check_child(node, &["link", "joint"])?;
        }
    }
    add_world(&robot, &mut document);
    Ok(document)
}

/// Adds the link `world` if joints have it as parent and the file does not declare it, as Drake does.
fn add_world(robot: &Element<'_>, document: &mut Document) {
    let joints = &document.joints;
    if joints.iter().all(|joint| joint.parent != WORLD) {
        return;
    }
    // Another link without a parent joint is the root.
    let children: HashSet<&str> = joints.iter().map(|joint| joint.child.as_str()).collect();
    let mut names = document.links.iter().map(|link| link.named.name.as_str());
    if names.any(|name| name == WORLD || !children.contains(name)) {
        return;
    }
    robot.note(RepairKind::WorldAdded);
    let (name, offset) = (WORLD.to_owned(), robot.offset());
    document.links.push(LinkElement {
        named: Named { name, offset },
        link: Link::default(),
    });
}

fn name_of(robot: &Element<'_>) -> Read<Named> {
    let read = robot.named();
    if read.is_ok() || !robot.reading.lenient {
        return read;
    }
    robot.note(RepairKind::Named { name: DEFAULT_NAME });
    let (name, offset) = (DEFAULT_NAME.to_owned(), robot.offset());
    Ok(Named { name, offset })
}

/// Returns an error for xacro directives, and for `${…}` or `$(…)` in attributes that the reader uses. A call of an
/// undefined macro is a remnant of an earlier expansion: it is left out with a note.
fn check_macros(reading: &Reading<'_>, root: Node<'_, '_>) -> Read<()> {
    let is_xacro = |node: &Node<'_, '_>| {
        let namespace = node.tag_name().namespace();
        namespace.is_some_and(|uri| uri.ends_with("/xacro"))
    };
    let is_macro = |node: &Node<'_, '_>| {
        let mut names = ["robot", "link", "joint"]
            .into_iter()
            .chain(READ_ELEMENTS.map(|(name, _)| name));
        let is_read = names.any(|name| is(*node, name));
        // Elements with these names count anywhere, so an `<origin>` within a `<visual>` is checked too.
        is_xacro(node) && DIRECTIVES.contains(&node.tag_name().name())
            || is_read
                && node
                    .attributes()
                    .any(|a| ["${", "$("].iter().any(|m| a.value().contains(m)))
    };
    if let Some(node) = root.descendants().find(is_macro) {
        return Err(RobotFileError::Xacro {
            file: reading.file.to_owned(),
            line: reading.line(node.range().start),
        });
    }
    for call in root.descendants().filter(is_xacro) {
        let element = format!("<xacro:{}>", call.tag_name().name());
        reading.note(call.range().start, &element, RepairKind::MacroCallLeftOut);
    }
    Ok(())
}
