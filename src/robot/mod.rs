//! Robots: a model with its mimic joints, and the reader for URDF files.

mod base_joint;
mod chain;
#[cfg(feature = "mjcf")]
#[cfg_attr(not(feature = "collision"), allow(dead_code))] // Collision models ask them.
mod contacts;
mod drive;
#[cfg(feature = "yaml")]
mod joint_limits;
mod link;
mod masses;
mod mimic;
#[cfg(feature = "mjcf")]
mod mjcf;
mod sole;
#[cfg(feature = "xml")]
mod srdf;
#[cfg(feature = "urdf")]
mod urdf;
#[cfg(feature = "xml")]
mod xml;

pub use base_joint::BaseJoint;
pub use link::{Geometry, Inertial, LeftToMeshes, Link, Shape};
pub use mimic::Mimic;
#[cfg(feature = "mjcf")]
pub use mjcf::MjcfReader;
#[cfg(feature = "xml")]
pub use srdf::{DisabledPair, EndEffector, Group, GroupState, Srdf, SrdfReader, VirtualJoint};
#[cfg(feature = "urdf")]
pub use urdf::UrdfReader;
#[cfg(feature = "xml")]
pub use xml::{Fault, Mended, Repair, RobotFileError};

use std::path::{Path, PathBuf};

#[cfg(feature = "mjcf")]
pub(crate) use contacts::Contacts;
use drive::Drive;
use mimic::Mimics;

use crate::model::{
    FrameId, FrameRef, JointId, JointRef, Loop, Model, ModelBuilder, ModelError, ParameterMap,
    ParameterMapBuilder, UnknownName,
};
use crate::spatial::Placement;

/// A robot: joints and links as a [`Model`], and which of its joints follow others.
///
/// Every link is a frame of the model under the link's name; the root link stands in the world. A
/// configuration lists the joints that move in the order of the file, mimic joints among them;
/// solvers see the variables of [`map`](Self::map), where mimic joints and joints whose limits
/// leave them one value are gone.
#[derive(Clone, Debug)]
pub struct Robot {
    model: Model,
    mimics: Mimics,
    map: ParameterMap,
    /// By joint index; shorter where the last joints have none.
    drives: Vec<Drive>,
    /// By frame index; frames beyond are no links.
    links: Vec<Link>,
    passive: Vec<JointId>,
    /// Which links touch, where the file is MJCF.
    #[cfg(feature = "mjcf")]
    #[cfg_attr(not(feature = "collision"), allow(dead_code))]
    contacts: Option<Contacts>,
    /// Where it was read from.
    file: Option<PathBuf>,
    /// Whether the files it names are opened only below its folder.
    confined: bool,
    #[cfg(feature = "xml")]
    repairs: Vec<Repair>,
}

impl Robot {
    /// A robot of its parts.
    ///
    /// # Errors
    /// Mimic joints that are fixed, follow in a ring or have a number that is not finite.
    pub fn new(model: Model, mimics: Vec<Mimic>) -> Result<Self, ModelError> {
        let mimics = Mimics::of(&model, mimics);
        let (model, map) = mimics.applied(model)?;
        Ok(Self {
            model,
            mimics,
            map,
            drives: Vec::new(),
            links: Vec::new(),
            passive: Vec::new(),
            #[cfg(feature = "mjcf")]
            contacts: None,
            file: None,
            confined: false,
            #[cfg(feature = "xml")]
            repairs: Vec::new(),
        })
    }

    getters! {
        /// The robot's name.
        pub fn name(&self) -> &str = self.model.name();
        /// Its joints, links and limits.
        pub fn model(&self) -> &Model = &self.model;
        /// All joints free but the mimic ones, which follow.
        pub fn map(&self) -> &ParameterMap = &self.map;
        /// The joints that follow others.
        pub fn mimics(&self) -> &[Mimic] = &self.mimics.joints;
        /// Starts a parameter map in which the mimic joints follow; lock joints or free only some.
        ///
        /// ```
        /// # use kinopt::robot::Robot;
        /// let robot = Robot::read("models/franka_panda.urdf")?;
        /// // The arm alone, the fingers held open: the second follows the first.
        /// let finger = robot.model().joint("finger_left_slide")?;
        /// let arm = robot.parameters().with_locked(finger, 0.04).build()?;
        /// assert_eq!(arm.variables(), 7);
        /// // Three joints, the others at the neutral configuration.
        /// let wrist = robot.joints(&["joint5", "joint6", "joint7"])?;
        /// let wrist = robot.parameters().with_only(&wrist, &robot.model().neutral()).build()?;
        /// assert_eq!(wrist.variables(), 3);
        /// # Ok::<(), Box<dyn std::error::Error>>(())
        /// ```
        pub fn parameters(&self) -> ParameterMapBuilder<'_> = coupled(&self.model, &self.mimics.joints);
        /// The joints that nothing drives: of an MJCF file with actuators those that none of them moves, by itself or
        /// through a fixed tendon, and that follow no other; else those that were
        /// [said to be](Self::with_passive_joints).
        pub fn passive_joints(&self) -> &[JointId] = &self.passive;
        /// The frames on which nothing hangs: hands, tools, feet.
        pub fn tips(&self) -> Vec<FrameId> = chain::tips(&self.model);
        /// The shapes and mass of a link, which is a frame; `None` for frames that are no links, such as
        /// tools, and for robots that came from no file.
        pub fn link(&self, frame: FrameId) -> Option<&Link> = self.links.get(frame.index());
        /// The file that it was read from, whose folder relative paths of meshes count from; `None` for one that was
        /// parsed from memory, unless [said](Self::with_file).
        pub fn file(&self) -> Option<&Path> = self.file.as_deref();
        /// Whether meshes are opened only below the folder of the robot's file and below the package folders that the caller lists:
        /// see [`confined`](Self::confined).
        pub fn is_confined(&self) -> bool = self.confined;
    }

    setters! {
        /// The same robot as if it had been read from this file, which need not exist.
        pub fn with_file(mut self, file: impl Into<PathBuf>) { self.file = Some(file.into()) }
        /// The same robot, of whose meshes only those below the folder of its file are opened, and those below the package folders
        /// of a collision model's builder. Robot files may name meshes anywhere: use this
        /// for files that are not trusted.
        pub fn confined(mut self) { self.confined = true }
    }

    /// Which links touch, where the file is MJCF.
    #[cfg(all(feature = "mjcf", feature = "collision"))]
    pub(crate) fn contacts(&self) -> Option<&Contacts> {
        self.contacts.as_ref()
    }

    /// What the file leaves to defaults or gets wrong, and what was taken instead, in its order.
    #[cfg(feature = "xml")]
    #[must_use]
    pub fn repairs(&self) -> &[Repair] {
        &self.repairs
    }

    /// The same robot with these as its [passive joints](Self::passive_joints), as an SRDF file names them
    /// ([`Srdf::passive_joints`]).
    ///
    /// # Errors
    /// The first joint that the robot does not have; the error lists the valid names.
    pub fn with_passive_joints<'a, J: Into<JointRef<'a>>>(
        mut self,
        joints: impl IntoIterator<Item = J>,
    ) -> Result<Self, UnknownName> {
        let joints = joints.into_iter();
        let resolved: Result<_, _> = joints
            .map(|joint| joint.into().resolve(&self.model))
            .collect();
        self.passive = resolved?;
        Ok(self)
    }

    /// Looks several joints up.
    ///
    /// # Errors
    /// The first unknown name; the error lists the valid ones.
    pub fn joints(&self, names: &[&str]) -> Result<Vec<JointId>, UnknownName> {
        names.iter().map(|name| self.model.joint(name)).collect()
    }

    /// The moving joints between two frames, from base to tip: down the tree, or up from the base
    /// to where both meet and down to the tip.
    ///
    /// # Errors
    /// A frame that the robot does not have; the error lists the valid names.
    pub fn chain<'a>(
        &self,
        base: impl Into<FrameRef<'a>>,
        tip: impl Into<FrameRef<'a>>,
    ) -> Result<Vec<JointId>, UnknownName> {
        let base = base.into().resolve(&self.model)?;
        let tip = tip.into().resolve(&self.model)?;
        Ok(chain::between(&self.model, base, tip))
    }

    /// The same robot with one more frame, `link_from_tool` away from the frame `link`. The ids of
    /// joints and frames stay as they are.
    ///
    /// ```
    /// # use kinopt::robot::Robot;
    /// # use kinopt::spatial::{Placement, Vector3};
    /// let gripper = Placement::translation(Vector3::new(0.0, 0.0, 0.12));
    /// let robot = Robot::read("models/universal_ur5e.urdf")?.with_tool("tool", "flange", gripper)?;
    /// assert!(robot.model().frame("tool").is_ok());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// An unknown `link`, a `name` that is taken, or a placement that is not rigid.
    pub fn with_tool<'a>(
        self,
        name: &str,
        link: impl Into<FrameRef<'a>>,
        link_from_tool: impl Into<Placement<f64>>,
    ) -> Result<Self, ToolError> {
        let link = &self.model.frames()[link.into().resolve(&self.model)?.index()];
        let (joint, joint_from_tool) = (link.joint, link.joint_from_frame * link_from_tool.into());
        let mut builder = ModelBuilder::from_model(&self.model);
        builder.frame(name, joint, joint_from_tool);
        Ok(Self {
            model: builder.build()?,
            ..self
        })
    }
}

impl Robot {
    /// The same robot with a loop that its file does not know of, as URDF has none: see [`Loop`].
    ///
    /// # Errors
    /// A loop's name that is taken, a frame that the robot does not have, places that are not rigid, or a
    /// loop that no configuration closes.
    pub fn with_loop(self, closed: Loop) -> Result<Self, ModelError> {
        let mut builder = ModelBuilder::from_model(&self.model);
        builder.close(closed);
        Ok(Self {
            model: builder.build()?,
            ..self
        })
    }

    setters! {
        /// The same robot without the loops of its file, for one whose loops contradict each other or are not meant.
        pub fn without_loops(mut self) { self.model = self.model.without_loops() }
    }
}

/// Why a tool cannot be put on a robot.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ToolError {
    /// No frame has the name.
    #[error(transparent)]
    UnknownLink(#[from] UnknownName),
    /// The tool's own name or placement is wrong.
    #[error(transparent)]
    Model(#[from] ModelError),
}

/// All joints free, but that some follow.
pub(crate) fn coupled<'m>(model: &'m Model, mimics: &[Mimic]) -> ParameterMapBuilder<'m> {
    let free = ParameterMap::builder(model);
    mimics.iter().fold(free, |map, mimic| {
        map.with_coupled(mimic.joint, mimic.master, mimic.ratio, mimic.offset)
    })
}
