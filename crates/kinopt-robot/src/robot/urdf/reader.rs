//! Conversion of a URDF document to a robot.

use std::borrow::Cow;
use std::path::Path;

use super::document::{self, Document};
use super::joint_element::JointChain;
use super::topology::{self, Topology};
use crate::robot::xml::{Reading, Repair, RobotFileError, repaired_xml};
use crate::robot::{DriveLimits, Mimic, Robot};
use kinopt_kinematics::file::{FileLocation, ReadError, read_bytes};
use kinopt_kinematics::model::{Joint, JointId, Limits, Model, ModelError};
use kinopt_kinematics::spatial::Placement;

/// Largest file size that is read, bytes; robot files stay below 1 MB.
const LENGTH_LIMIT: u64 = 64 << 20;

/// URDF reader, strict by default.
#[derive(Clone, Copy, Debug, Default)]
pub struct UrdfReader {
    lenient: bool,
    confined: bool,
}

impl UrdfReader {
    /// Corrects faults that have a single sensible correction, and lists each one: see [`Robot::repairs`] and
    /// [`RepairKind`](crate::robot::RepairKind).
    ///
    /// The corrections are:
    /// - Limits out of order are exchanged.
    /// - An infinite `lower` or `upper` is no limit.
    /// - A joint without its required `<limit>` is locked at 0.
    /// - The first of repeated elements counts.
    /// - Commas between numbers count as spaces.
    /// - Misspelt names are left out, and so are invalid velocities, efforts and soft limits.
    /// - A robot without a name gets one.
    /// - XML declarations may be anywhere.
    /// - Undeclared prefixes are declared.
    ///
    /// Faults that would need a guess at the kinematics stay errors.
    ///
    /// ```
    /// use kinopt::robot::Robot;
    ///
    /// let text = r#"<robot name="door"><link name="frame"/><link name="leaf"/>
    ///   <joint name="hinge" type="revolute"><parent link="frame"/><child link="leaf"/>
    ///     <limit lower="1.5" upper="0"/></joint></robot>"#;
    /// assert!(Robot::parse(text, "door.urdf").is_err());
    /// let robot = Robot::reader().lenient().parse(text, "door.urdf")?;
    /// assert_eq!(
    ///     robot.repairs()[0].to_string(),
    ///     "3: joint `hinge`, <limit>: limits out of order, taken as 0 to 1.5"
    /// );
    /// # Ok::<(), kinopt::robot::RobotFileError>(())
    /// ```
    #[must_use]
    pub fn lenient(mut self) -> Self {
        self.lenient = true;
        self
    }

    /// Restricts mesh files to the folder of the robot's file: see [`Robot::confined`]. An MJCF file may include
    /// only files below that folder.
    #[must_use]
    pub fn confined(mut self) -> Self {
        self.confined = true;
        self
    }

    /// Reads a robot file.
    ///
    /// # Errors
    /// As [`Robot::read`].
    pub fn read(&self, path: impl AsRef<Path>) -> Result<Robot, RobotFileError> {
        let path = path.as_ref();
        let file = path.display().to_string();
        let bytes = read_bytes(path, LENGTH_LIMIT)?;
        match std::str::from_utf8(&bytes) {
            Ok(text) => Ok(self.parse(text, &file)?.with_file(path)),
            Err(error) => {
                let location = FileLocation::Byte(error.valid_up_to());
                Err(ReadError::malformed(&file, location, "is not UTF-8 text").into())
            }
        }
    }

    /// Reads a document from memory. `file` is the file name for error messages.
    ///
    /// # Errors
    /// As [`Robot::read`].
    pub fn parse(&self, text: &str, file: &str) -> Result<Robot, RobotFileError> {
        #[cfg(feature = "mjcf")]
        if Robot::is_mjcf(text) {
            let reader = Robot::mjcf_reader();
            let reader = if self.confined {
                reader.confined()
            } else {
                reader
            };
            return reader.parse(text, file);
        }
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut repairs: Vec<Repair> = Vec::new();
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
        let document = document::read(&reading)?;
        let topology = topology::order(&reading, &document)?;
        let offsets: Vec<(String, usize)> = (document.joints.iter())
            .map(|joint| (joint.named.name.clone(), joint.named.offset))
            .collect();
        let mut robot = robot(document, &topology).map_err(|source| RobotFileError::Model {
            file: file.to_owned(),
            source,
        })?;
        for (joint, kind) in robot.mimics_beyond_range() {
            let name = &robot.model().joints()[joint.index()].name;
            if let Some((name, offset)) = offsets.iter().find(|(other, _)| other == name) {
                reading.note(*offset, &format!("joint `{name}`"), kind);
            }
        }
        robot.repairs = reading.repairs.into_inner();
        robot.repairs.sort_by_key(|repair| repair.line);
        robot.confined = self.confined;
        Ok(robot)
    }
}

fn robot(document: Document, topology: &Topology) -> Result<Robot, ModelError> {
    let mut builder = Model::builder(document.robot.name.as_str());
    let mut carrier: Vec<Option<JointId>> = vec![None; document.links.len()];
    let mut ids: Vec<Option<JointId>> = vec![None; document.joints.len()];
    let mut drives = Vec::with_capacity(document.joints.len());
    for branch in &topology.branches {
        let element = &document.joints[branch.joint];
        let (name, parent) = (element.named.name.as_str(), carrier[branch.parent_link]);
        let (placement, unbounded) = (element.parent_from_joint, Limits::UNBOUNDED);
        let id = match element.chain {
            JointChain::One => builder.joint(Joint::new(
                name,
                parent,
                placement,
                element.kind,
                element.axis,
                element.limits,
            )),
            JointChain::Free => builder.free(name, parent, placement, [unbounded; 3]),
            JointChain::Planar => builder.planar(
                name,
                parent,
                placement,
                element.axis,
                [unbounded; 2],
                unbounded,
            ),
        };
        carrier[branch.child_link] = Some(id);
        ids[branch.joint] = Some(id);
        // Only the last joint of a chain has the drive limits of the file.
        drives.resize(id.index(), DriveLimits::default());
        drives.push(element.drive);
    }
    for (link, joint) in document.links.iter().zip(&carrier) {
        builder.frame(link.named.name.as_str(), *joint, Placement::identity());
    }
    let in_file_order = (document.joints.iter().zip(&ids))
        .filter(|(element, _)| element.kind.moves())
        .filter_map(|(element, id)| {
            let last = (*id)?.index();
            let earlier_joints = match element.chain {
                JointChain::One => 0,
                JointChain::Planar => 2,
                JointChain::Free => 3,
            };
            Some((last - earlier_joints..=last).map(JointId::new))
        })
        .flatten()
        .collect();
    builder.configuration_order(in_file_order);

    let mimics = (document.joints.iter().zip(&ids).zip(&topology.sources))
        .filter_map(|((element, joint), source)| {
            let mimic = element.mimic.as_ref()?;
            Some(Mimic {
                joint: (*joint)?,
                master: ids[(*source)?]?,
                ratio: mimic.ratio,
                offset: mimic.offset,
            })
        })
        .collect();
    let mut robot = Robot::new(builder.build()?, mimics)?;
    robot.drives = drives;
    robot.links = document.links.into_iter().map(|link| link.link).collect();
    Ok(robot)
}

impl Robot {
    /// A reader with options.
    #[must_use]
    pub fn reader() -> UrdfReader {
        UrdfReader::default()
    }

    /// Reads a URDF file. With feature `mjcf` it also reads MJCF, recognised by its root element `<mujoco>`, as
    /// `read_mjcf` does.
    ///
    /// Links become frames; every joint keeps its name. A configuration lists the moving joints in the order of the
    /// file. An axis may have any length but zero, and is x by default. A missing `lower` or `upper` is 0 by the
    /// standard, or no limit from URDF 1.2 on; [`repairs`](Self::repairs) lists it.
    ///
    /// A source joint of `mimic` joints keeps its own limits (see [`with_mimic_limits`](Self::with_mimic_limits)). A
    /// `floating` joint NAME is a [free](kinopt_kinematics::model::ModelBuilder::free) joint: `NAME/x`, `NAME/y`, `NAME/z` and
    /// `NAME/rotation`. A `planar` joint is `NAME/x`, `NAME/y` and `NAME/yaw`. A `spherical` joint is a ball joint.
    /// [`with_base_joint`](Self::with_base_joint) moves the whole robot.
    ///
    /// The robot also has the velocity, effort and soft limits of the file: see
    /// [`velocity_limit`](Self::velocity_limit), [`effort_limit`](Self::effort_limit) and
    /// [`soft_limits`](Self::soft_limits). [`link`](Self::link) returns shapes and masses. The reader does not open
    /// mesh files, so `package://` paths need no ROS. Extensions are ignored.
    ///
    /// ```
    /// # std::env::set_current_dir("../..")?;
    /// use kinopt::robot::Robot;
    ///
    /// let robot = Robot::read("models/universal_ur5e.urdf")?;
    /// assert_eq!(robot.model().degrees_of_freedom(), 6);
    /// let arm = robot.chain("base", "flange")?;
    /// assert_eq!(arm.len(), 6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// A fault of the file, with line and element: see [`RobotFileError`] and [`ParseIssue`](crate::robot::ParseIssue).
    ///
    /// Xacro files are not expanded. A macro call that remains in an expanded file is left out with a note. A link
    /// `world` that joints refer to without a declaration is added with a note.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, RobotFileError> {
        Self::reader().read(path)
    }

    /// Reads a URDF document from memory. `file` is the file name for error messages.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn parse(text: &str, file: &str) -> Result<Self, RobotFileError> {
        Self::reader().parse(text, file)
    }
}
