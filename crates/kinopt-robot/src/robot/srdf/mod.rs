//! SRDF: joint groups, group states, passive joints, and collision pairs that need no check.

mod group;
mod reader;
mod state;

use std::path::Path;

pub use group::Group;
pub use reader::SrdfReader;
pub use state::GroupState;

use super::Robot;
use super::xml::{Repair, RobotFileError};
use kinopt_kinematics::model::{FrameId, JointId, ParameterMapBuilder, UnknownName};

/// Contents of an SRDF file, checked against one robot: all ids are ids of that robot.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Srdf {
    /// Joint groups, in the order of the file.
    pub groups: Vec<Group>,
    /// Named joint values.
    pub states: Vec<GroupState>,
    /// Grippers, tools and feet.
    pub end_effectors: Vec<EndEffector>,
    /// Passive joints that move.
    pub passive_joints: Vec<JointId>,
    /// Joints between the world and the robot. [`Robot::with_base_joint`] adds such a joint to a robot.
    pub virtual_joints: Vec<VirtualJoint>,
    /// Link pairs without collision checks.
    pub disabled_pairs: Vec<DisabledPair>,
    /// Elements that a [lenient](SrdfReader::lenient) reader left out, in the order of the file.
    pub repairs: Vec<Repair>,
}

/// An end effector: a group attached to a link of another group.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct EndEffector {
    /// Name of the end effector.
    pub name: String,
    /// Name of its group.
    pub group: String,
    /// Link to which it is fixed.
    pub parent_link: FrameId,
    /// Group of the parent link, if the file states it.
    pub parent_group: Option<String>,
}

/// A joint between the world and the robot, as the file describes it.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct VirtualJoint {
    /// Name of the joint.
    pub name: String,
    /// Joint type: `fixed`, `floating` or `planar`.
    pub kind: String,
    /// A frame outside the robot.
    pub parent_frame: String,
    /// Link that the joint carries.
    pub child_link: FrameId,
}

/// Two links that collision checks may skip.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct DisabledPair {
    /// The two links.
    pub links: [FrameId; 2],
    /// `Adjacent`, `Never`, `Default` or other text; may be empty.
    pub reason: String,
}

impl Srdf {
    /// Reads an SRDF file for a robot.
    ///
    /// ```
    /// use kinopt::robot::{Robot, Srdf};
    ///
    /// let door = r#"<robot name="door"><link name="frame"/><link name="leaf"/><link name="handle"/>
    ///   <joint name="hinge" type="continuous"><parent link="frame"/><child link="leaf"/></joint>
    ///   <joint name="latch" type="continuous"><parent link="leaf"/><child link="handle"/></joint></robot>"#;
    /// let robot = Robot::parse(door, "door.urdf")?;
    /// let srdf = r#"<robot name="door"><group name="opening"><chain base_link="frame" tip_link="leaf"/></group>
    ///   <passive_joint name="latch"/></robot>"#;
    /// let srdf = Srdf::parse(srdf, "door.srdf", &robot)?;
    /// let opening = srdf.group("opening")?;
    /// assert_eq!(opening.joints, [robot.model().joint("hinge")?]);
    /// let map = srdf.driven(&robot, &[0.0, 0.3]).build()?;
    /// assert_eq!(map.variables(), 1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// A fault of the file, with line and element: unknown joints, links and groups, groups that contain themselves, or
    /// joint values that are no numbers or have the wrong count.
    pub fn read(path: impl AsRef<Path>, robot: &Robot) -> Result<Self, RobotFileError> {
        Self::reader().read(path, robot)
    }

    /// Reads a document from memory. `file` is the file name for error messages.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn parse(text: &str, file: &str, robot: &Robot) -> Result<Self, RobotFileError> {
        Self::reader().parse(text, file, robot)
    }

    /// A reader with options. The default is strict, as [`read`](Self::read).
    #[must_use]
    pub fn reader() -> SrdfReader {
        SrdfReader::default()
    }

    /// Looks up a group by name.
    ///
    /// # Errors
    /// An unknown name. The error lists the valid ones.
    pub fn group(&self, name: &str) -> Result<&Group, UnknownName> {
        let names = self.groups.iter().map(|group| group.name.as_str());
        let group = self.groups.iter().find(|group| group.name == name);
        group.ok_or_else(|| UnknownName::new("group", name, names))
    }

    /// Starts a parameter map of the robot in which passive joints are locked at their values in `q`. Passive mimic
    /// joints stay coupled to their sources.
    #[must_use]
    pub fn driven<'r>(&self, robot: &'r Robot, q: &[f64]) -> ParameterMapBuilder<'r> {
        let model = robot.model();
        let mut builder = robot.parameters();
        for &joint in &self.passive_joints {
            let Some(at) = model.coordinate(joint) else {
                continue;
            };
            if robot.mimics().iter().any(|mimic| mimic.joint == joint) {
                continue;
            }
            let is_ball = model.joints()[joint.index()].kind.is_ball();
            builder = match (is_ball, q.get(at..)) {
                (false, Some([value, ..])) => builder.with_locked(joint, *value),
                (true, Some([w, x, y, z, ..])) => builder.with_locked_ball(joint, [*w, *x, *y, *z]),
                // `q` is too short: building the map returns the error.
                _ => builder.with_only(&[], q),
            };
        }
        builder
    }

    /// Starts a parameter map of the robot in which only the joints of a group are free. Other joints are locked at
    /// their values in `q`.
    ///
    /// # Errors
    /// An unknown group. The error lists the valid ones.
    pub fn only<'r>(
        &self,
        robot: &'r Robot,
        group: &str,
        q: &[f64],
    ) -> Result<ParameterMapBuilder<'r>, UnknownName> {
        // Mimic joints stay coupled in either case.
        let joints = &self.group(group)?.joints;
        Ok(robot.parameters().with_only(joints, q))
    }
}
