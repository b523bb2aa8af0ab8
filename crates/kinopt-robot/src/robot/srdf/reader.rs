//! Conversion of an SRDF document.

use std::borrow::Cow;
use std::path::Path;

use roxmltree::Node;

use super::{DisabledPair, EndEffector, Srdf, VirtualJoint, group, state};
use crate::robot::Robot;
use crate::robot::xml::{
    Element, ParseIssue, Read, Reading, RobotFileError, is, parse as parse_xml, repaired_xml,
};
use kinopt_kinematics::file::{FileLocation, ReadError, read_bytes};
use kinopt_kinematics::model::{FrameId, UnknownName};

/// Largest file size that is read, bytes; SRDF files stay below 1 MB.
const LENGTH_LIMIT: u64 = 64 << 20;

/// SRDF reader, strict by default.
#[derive(Clone, Copy, Debug, Default)]
pub struct SrdfReader {
    lenient: bool,
}

impl SrdfReader {
    /// Leaves out faulty elements and lists them in [`Srdf::repairs`]. Published files often name joints or links
    /// of another version of the robot.
    ///
    /// The reader leaves out:
    /// - passive joints, end effectors, virtual joints and disabled pairs with unknown names;
    /// - joints, links, chains and subgroups with unknown names in groups and states;
    /// - states of unknown groups;
    /// - the second group of a name.
    ///
    /// A group that contains itself gets the joints of all groups of the cycle.
    ///
    /// ```
    /// use kinopt::robot::{Robot, Srdf};
    ///
    /// let door = r#"<robot name="door"><link name="frame"/><link name="leaf"/>
    ///   <joint name="hinge" type="continuous"><parent link="frame"/><child link="leaf"/></joint></robot>"#;
    /// let robot = Robot::parse(door, "door.urdf")?;
    /// let text = r#"<robot name="door"><group name="opening"><joint name="hinge"/></group>
    ///   <passive_joint name="latch"/></robot>"#;
    /// assert!(Srdf::parse(text, "door.srdf", &robot).is_err());
    /// let srdf = Srdf::reader().lenient().parse(text, "door.srdf", &robot)?;
    /// assert_eq!(srdf.group("opening")?.joints.len(), 1);
    /// let repair = srdf.repairs[0].to_string();
    /// assert!(repair.starts_with("2: passive_joint `latch`: left out: "), "{repair}");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn lenient(mut self) -> Self {
        self.lenient = true;
        self
    }

    /// Reads an SRDF file for a robot.
    ///
    /// # Errors
    /// As [`Srdf::read`]. A lenient reader fails only if the file cannot be read or is not SRDF.
    pub fn read(&self, path: impl AsRef<Path>, robot: &Robot) -> Result<Srdf, RobotFileError> {
        let path = path.as_ref();
        let file = path.display().to_string();
        let bytes = read_bytes(path, LENGTH_LIMIT)?;
        let text = std::str::from_utf8(&bytes).map_err(|error| {
            let location = FileLocation::Byte(error.valid_up_to());
            ReadError::malformed(&file, location, "is not UTF-8 text")
        })?;
        self.parse(text, &file, robot)
    }

    /// Reads a document from memory. `file` is the file name for error messages.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn parse(&self, text: &str, file: &str, robot: &Robot) -> Result<Srdf, RobotFileError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut repairs = Vec::new();
        let text = match self.lenient {
            true => repaired_xml(text, &mut repairs),
            false => Cow::Borrowed(text),
        };
        let reading = Reading {
            file,
            text: &text,
            lenient: self.lenient,
            repairs: repairs.into(),
        };
        let mut srdf = read(&reading, robot)?;
        srdf.repairs = reading.repairs.into_inner();
        srdf.repairs.sort_by_key(|repair| repair.line);
        Ok(srdf)
    }
}

fn read(reading: &Reading<'_>, robot: &Robot) -> Read<Srdf> {
    let document = parse_xml(reading.file, reading.text)?;
    let root = document.root_element();
    if !root.has_tag_name("robot") {
        let label = format!("<{}>", root.tag_name().name());
        return Err(Element::new(reading, root, label).fault(ParseIssue::NotARobot));
    }
    let elements = |tag: &'static str| -> Vec<Element<'_>> {
        let nodes = root.children().filter(move |node| is(*node, tag));
        nodes.map(|node| labelled(reading, node, tag)).collect()
    };
    let virtual_joints = all(&elements("virtual_joint"), |element| {
        Ok(VirtualJoint {
            name: element.name("name")?,
            kind: element.name("type")?,
            parent_frame: element.name("parent_frame")?,
            child_link: link(element, "child_link", robot)?,
        })
    })?;
    // Virtual joints with an unknown child link keep their names reserved.
    let virtual_elements = elements("virtual_joint");
    let virtual_names: Vec<&str> = (virtual_elements.iter())
        .filter_map(|element| element.text("name"))
        .collect();
    let groups = group::read_all(&elements("group"), robot, &virtual_names)?;
    let names: Vec<&str> = groups.iter().map(|group| group.name.as_str()).collect();
    let existing_group =
        |element: &Element<'_>, group: String| match names.contains(&group.as_str()) {
            true => Ok(group),
            false => {
                let unknown = UnknownName::new("group", &group, names.iter().copied());
                Err(element.fault(unknown.into()))
            }
        };
    let states = all(&elements("group_state"), |element| {
        state::read(element, robot, &names, &virtual_names)
    })?;
    let end_effectors = all(&elements("end_effector"), |element| {
        let parent_group = element
            .text("parent_group")
            .filter(|group| !group.is_empty());
        Ok(EndEffector {
            name: element.name("name")?,
            group: existing_group(element, element.name("group")?)?,
            parent_link: link(element, "parent_link", robot)?,
            parent_group: parent_group
                .map(|group| existing_group(element, group.to_owned()))
                .transpose()?,
        })
    })?;
    let passive_joints = all(&elements("passive_joint"), |element| {
        let name = element.name("name")?;
        if virtual_names.contains(&name.as_str()) {
            return Ok(None);
        }
        let unknown = |error: UnknownName| element.fault(error.into());
        let joint = robot.model().joint(&name).map_err(unknown)?;
        Ok(robot.model().coordinate(joint).map(|_| joint))
    })?;
    let disabled_pairs = all(&elements("disable_collisions"), |element| {
        let links = [
            link(element, "link1", robot)?,
            link(element, "link2", robot)?,
        ];
        let reason = element.text("reason").unwrap_or_default().to_owned();
        Ok(DisabledPair { links, reason })
    })?;
    Ok(Srdf {
        states,
        end_effectors,
        passive_joints: passive_joints.into_iter().flatten().collect(),
        disabled_pairs,
        groups,
        virtual_joints,
        repairs: Vec::new(),
    })
}

/// Reads all elements; a lenient reader leaves out faulty ones.
fn all<T>(elements: &[Element<'_>], read: impl Fn(&Element<'_>) -> Read<T>) -> Read<Vec<T>> {
    let mut all = Vec::with_capacity(elements.len());
    for element in elements {
        all.extend(element.reading.leniently(read(element))?);
    }
    Ok(all)
}

fn labelled<'a>(reading: &'a Reading<'a>, node: Node<'a, 'a>, tag: &str) -> Element<'a> {
    let label = match node.attribute("name") {
        Some(name) => format!("{tag} `{name}`"),
        None => format!("<{tag}>"),
    };
    Element::new(reading, node, label)
}

fn link(element: &Element<'_>, attribute: &'static str, robot: &Robot) -> Read<FrameId> {
    let name = element.name(attribute)?;
    let unknown = |error: UnknownName| element.fault(error.into());
    robot.model().frame(&name).map_err(unknown)
}
