//! From a file to a robot.

use std::borrow::Cow;
use std::path::Path;

use super::document::{self, Document};
use super::joint_element::JointChain;
use super::topology::{self, Topology};
use crate::file::{Place, ReadError, read_bytes};
use crate::model::{Joint, JointId, Limits, Model, ModelError};
use crate::robot::xml::{Reading, Repair, RobotFileError, mended};
use crate::robot::{Drive, Mimic, Robot};
use crate::spatial::Placement;

/// The longest file that is read; real robots stay below 1 MB.
const LENGTH_LIMIT: u64 = 64 << 20;

/// Reads URDF: strictly, unless asked to be lenient.
#[derive(Clone, Copy, Debug, Default)]
pub struct UrdfReader {
    lenient: bool,
    confined: bool,
}

impl UrdfReader {
    setters! {
        /// Mends what can be mended in one way only, and lists each repair: see
        /// [`Robot::repairs`] and [`Mended`](crate::robot::Mended).
        ///
        /// Limits out of order are exchanged; an infinite `lower` or `upper` is no limit; a joint that needs `<limit>` and has none is held at 0; of
        /// an element that stands twice the first counts; commas between numbers are blanks; misspelt
        /// names, and speeds, efforts and soft limits that are no numbers, are left out; a robot without
        /// a name gets one; XML declarations may stand anywhere and prefixes be undeclared. Whatever
        /// would need a guess at the kinematics stays an error.
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
        pub fn lenient(mut self) { self.lenient = true }
        /// Confines the robot to the folder of its file: see [`Robot::confined`]. An MJCF file includes only files below that folder.
        pub fn confined(mut self) { self.confined = true }
    }

    /// Reads a file.
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
                let at = Place::Byte(error.valid_up_to());
                Err(ReadError::malformed(&file, at, "is not UTF-8 text").into())
            }
        }
    }

    /// Reads a document from memory; `file` is the name that errors give it.
    ///
    /// # Errors
    /// As [`Robot::read`].
    pub fn parse(&self, text: &str, file: &str) -> Result<Robot, RobotFileError> {
        #[cfg(feature = "mjcf")]
        if crate::robot::xml::root_name(text) == Some("mujoco") {
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
            true => mended(text, &mut repairs),
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
        let starts: Vec<(String, usize)> = (document.joints.iter())
            .map(|joint| (joint.named.name.clone(), joint.named.at))
            .collect();
        let mut robot = robot(document, &topology).map_err(|source| RobotFileError::Model {
            file: file.to_owned(),
            source,
        })?;
        for (joint, mended) in robot.mimics_beyond_range() {
            let name = &robot.model().joints()[joint.index()].name;
            if let Some((name, at)) = starts.iter().find(|(own, _)| own == name) {
                reading.note(*at, &format!("joint `{name}`"), mended);
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
        let (at, free) = (element.parent_from_joint, Limits::UNBOUNDED);
        let id = match element.chain {
            JointChain::One => builder.joint(Joint::new(
                name,
                parent,
                at,
                element.kind,
                element.axis,
                element.limits,
            )),
            JointChain::Free => builder.free(name, parent, at, [free; 3]),
            JointChain::Planar => builder.planar(name, parent, at, element.axis, [free; 2], free),
        };
        carrier[branch.child_link] = Some(id);
        ids[branch.joint] = Some(id);
        // Those that a chain has before its last joint have no drive of their own.
        drives.resize(id.index(), Drive::default());
        drives.push(element.drive);
    }
    for (link, joint) in document.links.iter().zip(&carrier) {
        builder.frame(link.named.name.as_str(), *joint, Placement::identity());
    }
    let in_file_order = (document.joints.iter().zip(&ids))
        .filter(|(element, _)| element.kind.moves())
        .filter_map(|(element, id)| {
            let last = (*id)?.index();
            let before = match element.chain {
                JointChain::One => 0,
                JointChain::Planar => 2,
                JointChain::Free => 3,
            };
            Some((last - before..=last).map(JointId::new))
        })
        .flatten()
        .collect();
    builder.configuration_order(in_file_order);

    let mimics = (document.joints.iter().zip(&ids).zip(&topology.masters))
        .filter_map(|((element, joint), master)| {
            let follows = element.follows.as_ref()?;
            Some(Mimic {
                joint: (*joint)?,
                master: ids[(*master)?]?,
                ratio: follows.ratio,
                offset: follows.offset,
            })
        })
        .collect();
    let mut robot = Robot::new(builder.build()?, mimics)?;
    robot.drives = drives;
    robot.links = document.links.into_iter().map(|link| link.link).collect();
    Ok(robot)
}

impl Robot {
    /// How URDF is read, with choices.
    #[must_use]
    pub fn reader() -> UrdfReader {
        UrdfReader::default()
    }

    /// Reads a URDF file; with feature `mjcf` also MJCF, told by its element `<mujoco>`, as `read_mjcf` does.
    ///
    /// Links become frames; every joint keeps its name; a configuration lists the moving joints in
    /// the order of the file. `mimic` joints follow their master, which keeps its own limits (see
    /// [`with_mimic_limits`](Self::with_mimic_limits)). An axis need not be of unit length, and is x where none is given. A missing `lower` or `upper` is
    /// 0, as the standard says (none from URDF 1.2 on), and noted in [`repairs`](Self::repairs).
    ///
    /// A `floating` joint NAME is a [free](crate::model::ModelBuilder::free) one, `NAME/x`, `NAME/y`, `NAME/z` and
    /// `NAME/rotation`; a `planar` one `NAME/x`, `NAME/y` and `NAME/yaw`; a `spherical` one a ball. To let the whole
    /// robot move, see [`with_base_joint`](Self::with_base_joint).
    ///
    /// Speeds, efforts and soft limits are kept ([`velocity_limit`](Self::velocity_limit),
    /// [`effort_limit`](Self::effort_limit), [`soft_limits`](Self::soft_limits)), and so are shapes
    /// and masses ([`link`](Self::link)); files of meshes are not opened, so `package://` paths
    /// need no ROS. Extensions are not looked at.
    ///
    /// ```
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
    /// What is wrong with the file, with line and name: see [`RobotFileError`] and
    /// [`Fault`](crate::robot::Fault). Xacro files are not expanded; a macro call that is left over in an expanded file is ignored with a
    /// note. A link `world` that joints hang on without a declaration is added with a note.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, RobotFileError> {
        Self::reader().read(path)
    }

    /// Reads a URDF document from memory; `file` is the name that errors give it.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn parse(text: &str, file: &str) -> Result<Self, RobotFileError> {
        Self::reader().parse(text, file)
    }
}
