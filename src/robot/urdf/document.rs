//! Looks at the XML itself, where urdf-rs would fill in silently or fail without naming a place.
//!
//! After these checks the document is cut down to what kinematics needs, so that no mesh path,
//! mass or extension can stop it, and nothing unchecked reaches urdf-rs, which does not look at
//! namespaces and has defaults of its own for every version of the standard.

use std::ops::Range;

use roxmltree::Node;

use super::attributes::{Named, Place, is, refuse_misspelt};
use super::error::{Fault, UrdfError};
use super::joint_element::{self, JointElement, KINEMATIC, Version};

/// A document whose elements are sound one by one.
#[derive(Clone, Debug)]
pub(super) struct Document {
    pub(super) robot: Named,
    pub(super) links: Vec<Named>,
    pub(super) joints: Vec<JointElement>,
    /// The same robot without anything but links and joints.
    pub(super) kinematic_text: String,
}

/// Reads and checks every link and joint on its own.
pub(super) fn read(file: &str, text: &str) -> Result<Document, UrdfError> {
    let xml = roxmltree::Document::parse(text).map_err(|error| match &error {
        roxmltree::Error::UnknownNamespace(prefix, at) if prefix == "xacro" => UrdfError::Xacro {
            file: file.to_owned(),
            line: at.row,
        },
        _ => UrdfError::NotXml {
            file: file.to_owned(),
            problem: error.to_string(),
        },
    })?;
    let place = Place { file, text };
    let root = xml.root_element();
    refuse_macros(&place, root)?;
    if !root.has_tag_name("robot") {
        let element = format!("<{}>", root.tag_name().name());
        return Err(place.fault(root.range().start, element, Fault::NotARobot));
    }
    let version = Version::of(root);

    let mut document = Document {
        robot: Named::read(&place, root, "<robot>")?,
        links: Vec::new(),
        joints: Vec::new(),
        kinematic_text: String::new(),
    };
    let mut cuts = Vec::new();
    cut_attributes(root, &["name"], &mut cuts);
    for node in root.children() {
        if is(node, "link") {
            document.links.push(Named::read(&place, node, "<link>")?);
            cut_attributes(node, &["name"], &mut cuts);
            cuts.extend(node.children().map(|child| child.range()));
        } else if is(node, "joint") {
            document
                .joints
                .push(joint_element::read(&place, node, version)?);
            cut_joint(node, &mut cuts);
        } else {
            if node.is_element() {
                refuse_misspelt(&place, node, "<robot>", &["link", "joint"])?;
            }
            cuts.push(node.range());
        }
    }
    document.kinematic_text = without(text, root.range(), &cuts);
    Ok(document)
}

/// Finds xacro's own elements, and `${…}` or `$(…)` where kinematics would read a number or name.
fn refuse_macros(place: &Place<'_>, root: Node<'_, '_>) -> Result<(), UrdfError> {
    let is_macro = |node: &Node<'_, '_>| {
        let namespace = node.tag_name().namespace();
        let ours = ["robot", "link", "joint"]
            .into_iter()
            .chain(KINEMATIC.map(|(name, _)| name))
            .any(|name| is(*node, name));
        // An <origin> within a <visual> is not ours, but a macro there is a macro all the same.
        namespace.is_some_and(|uri| uri.ends_with("/xacro"))
            || ours
                && node
                    .attributes()
                    .any(|a| a.value().contains("${") || a.value().contains("$("))
    };
    match root.descendants().find(is_macro) {
        Some(node) => Err(UrdfError::Xacro {
            file: place.file.to_owned(),
            line: place.line(node.range().start),
        }),
        None => Ok(()),
    }
}

/// Leaves a joint its kinematic children, and them their own attributes.
fn cut_joint(node: Node<'_, '_>, cuts: &mut Vec<Range<usize>>) {
    cut_attributes(node, &["name", "type"], cuts);
    for child in node.children() {
        match KINEMATIC.iter().find(|(name, _)| is(child, name)) {
            Some((_, attributes)) => {
                cut_attributes(child, attributes, cuts);
                cuts.extend(child.children().map(|inner| inner.range()));
            }
            None => cuts.push(child.range()),
        }
    }
}

fn cut_attributes(node: Node<'_, '_>, keep: &[&str], cuts: &mut Vec<Range<usize>>) {
    let foreign = (node.attributes())
        .filter(|a| a.namespace().is_some() || !keep.contains(&a.name()))
        .map(|a| a.range());
    cuts.extend(foreign);
}

/// The text within `keep`, less the `cuts`, which stand in order and do not overlap.
fn without(text: &str, keep: Range<usize>, cuts: &[Range<usize>]) -> String {
    let mut kept = String::new();
    let mut from = keep.start;
    for cut in cuts {
        kept.push_str(text.get(from..cut.start).unwrap_or_default());
        from = cut.end;
    }
    kept.push_str(text.get(from..keep.end).unwrap_or_default());
    kept
}
