//! SRDF: what a robot's description does not say: groups of joints, states, joints that nothing drives, links
//! that need not be kept apart.

mod group;
mod reader;
mod state;

use std::path::Path;

pub use group::Group;
pub use reader::SrdfReader;
pub use state::GroupState;

use super::Robot;
use super::xml::{Repair, RobotFileError};
use crate::model::{FrameId, JointId, ParameterMapBuilder, UnknownName};

/// A file of semantics, checked against the robot that it was read for: its ids are that robot's.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Srdf {
    /// Groups of joints, in the order of the file.
    pub groups: Vec<Group>,
    /// Named values of joints.
    pub states: Vec<GroupState>,
    /// Grippers, tools and feet.
    pub end_effectors: Vec<EndEffector>,
    /// Joints that nothing drives, which move.
    pub passive_joints: Vec<JointId>,
    /// How the robot stands in the world, which [`Robot::with_base_joint`] would do.
    pub virtual_joints: Vec<VirtualJoint>,
    /// Links that may touch, or never can.
    pub disabled_pairs: Vec<DisabledPair>,
    /// What a [lenient](SrdfReader::lenient) reader left out, in the order of the file.
    pub repairs: Vec<Repair>,
}

/// A group at the end of another.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct EndEffector {
    /// Its name.
    pub name: String,
    /// The group that it is.
    pub group: String,
    /// The link that it is fixed to.
    pub parent_link: FrameId,
    /// The group that carries it, if the file says.
    pub parent_group: Option<String>,
}

/// A joint between the world and the robot, as the file says it.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct VirtualJoint {
    /// Its name.
    pub name: String,
    /// fixed, floating or planar.
    pub kind: String,
    /// A frame that is not the robot's.
    pub parent_frame: String,
    /// The robot's link that it carries.
    pub child_link: FrameId,
}

/// Two links that collision checks may leave out.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct DisabledPair {
    /// The two.
    pub links: [FrameId; 2],
    /// Adjacent, Never, Default, …, or nothing.
    pub reason: String,
}

impl Srdf {
    /// Reads a file that speaks of a robot.
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
    /// What is wrong with the file, with line and name: joints, links and groups that there are not, groups that
    /// contain themselves, values of joints that are no numbers or not as many as the joint takes.
    pub fn read(path: impl AsRef<Path>, robot: &Robot) -> Result<Self, RobotFileError> {
        Self::reader().read(path, robot)
    }

    /// Reads a document from memory; `file` is the name that errors give it.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn parse(text: &str, file: &str, robot: &Robot) -> Result<Self, RobotFileError> {
        Self::reader().parse(text, file, robot)
    }

    /// A reader with options: strict, as [`read`](Self::read), unless told otherwise.
    #[must_use]
    pub fn reader() -> SrdfReader {
        SrdfReader::default()
    }

    /// Looks a group up.
    ///
    /// # Errors
    /// An unknown name; the error lists the valid ones.
    pub fn group(&self, name: &str) -> Result<&Group, UnknownName> {
        let names = self.groups.iter().map(|group| group.name.as_str());
        let found = self.groups.iter().find(|group| group.name == name);
        found.ok_or_else(|| UnknownName::new("group", name, names))
    }

    /// Starts a parameter map of the robot in which the joints that nothing drives are held as `q` has them,
    /// but those that follow others.
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
                // Too short: told when the map is built.
                _ => builder.with_only(&[], q),
            };
        }
        builder
    }

    /// Starts a parameter map of the robot in which only a group's joints move, the others held as `q` has them.
    ///
    /// # Errors
    /// An unknown group; the error lists the valid ones.
    pub fn only<'r>(
        &self,
        robot: &'r Robot,
        group: &str,
        q: &[f64],
    ) -> Result<ParameterMapBuilder<'r>, UnknownName> {
        // Those that follow others do so in either case.
        let joints = &self.group(group)?.joints;
        Ok(robot.parameters().with_only(joints, q))
    }
}
