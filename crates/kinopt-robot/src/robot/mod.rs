//! Robots: models with mimic joints, and readers of robot files.

mod base_joint;
mod chain;
#[cfg(feature = "mjcf")]
mod contacts;
mod drive;
#[cfg(feature = "yaml")]
mod joint_limits;
mod link;
mod loop_closure;
mod masses;
mod mimic;
#[cfg(feature = "mjcf")]
mod mjcf;
mod scaled;
mod sole;
#[cfg(feature = "xml")]
mod srdf;
#[cfg(feature = "urdf")]
mod urdf;
#[cfg(feature = "xml")]
mod xml;

pub use base_joint::BaseJoint;
pub use link::{Geometry, GeometryObject, Inertial, Link, MissingInertia};
pub use mimic::Mimic;
#[cfg(feature = "mjcf")]
pub use mjcf::MjcfReader;
#[cfg(feature = "xml")]
pub use srdf::{DisabledPair, EndEffector, Group, GroupState, Srdf, SrdfReader, VirtualJoint};
#[cfg(feature = "urdf")]
pub use urdf::{UrdfReader, with_origin_corrections};
#[cfg(feature = "xml")]
pub use xml::{ParseIssue, Repair, RepairKind, RobotFileError};

use std::path::{Path, PathBuf};

#[cfg(feature = "mjcf")]
#[doc(hidden)]
pub use contacts::Contacts;
use drive::DriveLimits;
use mimic::Mimics;

use kinopt_kinematics::model::{
    FrameId, FrameRef, JointId, JointRef, Loop, Model, ModelBuilder, ModelError, ParameterMap,
    ParameterMapBuilder, UnknownName,
};
use kinopt_kinematics::spatial::Placement;

/// A robot: joints and links as a [`Model`], and its mimic joints.
///
/// Every link is a frame of the model under the link's name; the root link is fixed in the world. A configuration lists
/// the moving joints in the order of the file, mimic joints included.
///
/// Solvers use the variables of [`map`](Self::map). The map has no variables for mimic joints and for joints whose
/// limits allow one value only.
#[derive(Clone, Debug)]
pub struct Robot {
    model: Model,
    mimics: Mimics,
    map: ParameterMap,
    /// By joint index; may be shorter than the list of joints.
    drives: Vec<DriveLimits>,
    /// By frame index; later frames are no links.
    links: Vec<Link>,
    passive: Vec<JointId>,
    /// Enabled collision pairs of an MJCF file.
    #[cfg(feature = "mjcf")]
    contacts: Option<Contacts>,
    /// File that the robot was read from.
    file: Option<PathBuf>,
    /// Mesh files outside the folder of the robot's file are rejected.
    confined: bool,
    #[cfg(feature = "xml")]
    repairs: Vec<Repair>,
}

impl Robot {
    /// Creates a robot from a model and mimic joints.
    ///
    /// # Errors
    /// Mimic joints that are fixed, that form a cycle, or that have a number that is not finite.
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

    /// Name of the robot.
    #[must_use]
    pub fn name(&self) -> &str {
        self.model.name()
    }

    /// Joints, links and limits.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The parameter map in which all joints are free except mimic joints.
    #[must_use]
    pub fn map(&self) -> &ParameterMap {
        &self.map
    }

    /// The mimic joints.
    #[must_use]
    pub fn mimics(&self) -> &[Mimic] {
        &self.mimics.joints
    }

    /// Starts a parameter map that couples the mimic joints. Lock joints or free only some.
    ///
    /// ```
    /// # std::env::set_current_dir("../..")?;
    /// # use kinopt::robot::Robot;
    /// let robot = Robot::read("models/franka_panda.urdf")?;
    /// // The arm alone with the fingers locked open: the second finger is a mimic joint of the first.
    /// let finger = robot.model().joint("finger_left_slide")?;
    /// let arm = robot.parameters().with_locked(finger, 0.04).build()?;
    /// assert_eq!(arm.variables(), 7);
    /// // Three joints, the others locked at the neutral configuration.
    /// let wrist = robot.joints(&["joint5", "joint6", "joint7"])?;
    /// let wrist = robot.parameters().with_only(&wrist, &robot.model().neutral()).build()?;
    /// assert_eq!(wrist.variables(), 3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn parameters(&self) -> ParameterMapBuilder<'_> {
        coupled(&self.model, &self.mimics.joints)
    }

    /// The passive joints: moving joints without an actuator.
    ///
    /// In an MJCF file with actuators they are the joints without an actuator, direct or through a fixed tendon,
    /// except mimic joints. Otherwise they are those set by [`with_passive_joints`](Self::with_passive_joints).
    #[must_use]
    pub fn passive_joints(&self) -> &[JointId] {
        &self.passive
    }

    /// The end frames of the tree, such as hands, tools and feet: frames whose joint carries no other joint.
    #[must_use]
    pub fn tips(&self) -> Vec<FrameId> {
        chain::tips(&self.model)
    }

    /// Shapes and mass of the link of a frame. `None` for frames that are no links, such as tools, and for robots
    /// without a file.
    #[must_use]
    pub fn link(&self, frame: FrameId) -> Option<&Link> {
        self.links.get(frame.index())
    }

    /// The file that the robot was read from; relative mesh paths are relative to its folder. `None` for a robot
    /// parsed from memory, unless [`with_file`](Self::with_file) sets it.
    #[must_use]
    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// Reports whether mesh files must be below the folder of the robot's file or below the package folders of the
    /// caller: see [`confined`](Self::confined).
    #[must_use]
    pub fn is_confined(&self) -> bool {
        self.confined
    }

    /// Sets the file that [`file`](Self::file) returns. It need not exist.
    #[must_use]
    pub fn with_file(mut self, file: impl Into<PathBuf>) -> Self {
        self.file = Some(file.into());
        self
    }

    /// Restricts mesh files to those below the folder of the robot's file and below the package folders of a
    /// collision model's builder. Use this for untrusted files, since robot files may name meshes anywhere.
    #[must_use]
    pub fn confined(mut self) -> Self {
        self.confined = true;
        self
    }

    /// Enabled collision pairs of an MJCF file.
    #[cfg(feature = "mjcf")]
    #[doc(hidden)] // For collision models.
    pub fn contacts(&self) -> Option<&Contacts> {
        self.contacts.as_ref()
    }

    /// Defaults and corrections that the reader applied, in the order of the file.
    #[cfg(feature = "xml")]
    #[must_use]
    pub fn repairs(&self) -> &[Repair] {
        &self.repairs
    }

    /// Sets the [passive joints](Self::passive_joints), for example those of an SRDF file ([`Srdf::passive_joints`]).
    ///
    /// # Errors
    /// The first unknown joint. The error lists the valid names.
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

    /// Looks up several joints by name.
    ///
    /// # Errors
    /// The first unknown name. The error lists the valid ones.
    pub fn joints(&self, names: &[&str]) -> Result<Vec<JointId>, UnknownName> {
        names.iter().map(|name| self.model.joint(name)).collect()
    }

    /// The moving joints between two frames: from `base` up to the common ancestor, then down to `tip`.
    ///
    /// # Errors
    /// An unknown frame. The error lists the valid names.
    pub fn chain<'a>(
        &self,
        base: impl Into<FrameRef<'a>>,
        tip: impl Into<FrameRef<'a>>,
    ) -> Result<Vec<JointId>, UnknownName> {
        let base = base.into().resolve(&self.model)?;
        let tip = tip.into().resolve(&self.model)?;
        Ok(chain::between(&self.model, base, tip))
    }

    /// Adds a frame fixed to the frame `link`. `link_from_tool` is the pose of the new frame in `link`, in metres. Ids
    /// of joints and frames do not change.
    ///
    /// ```
    /// # std::env::set_current_dir("../..")?;
    /// # use kinopt::robot::Robot;
    /// # use kinopt::spatial::{Placement, Vector3};
    /// let gripper = Placement::translation(Vector3::new(0.0, 0.0, 0.12));
    /// let robot = Robot::read("models/universal_ur5e.urdf")?.with_tool("tool", "flange", gripper)?;
    /// assert!(robot.model().frame("tool").is_ok());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// An unknown `link`, a `name` that already exists, or a placement that is not rigid.
    pub fn with_tool<'a>(
        self,
        name: &str,
        link: impl Into<FrameRef<'a>>,
        link_from_tool: impl Into<Placement<f64>>,
    ) -> Result<Self, ModelError> {
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
    /// Adds a loop closure that the file does not describe, as URDF has none: see [`Loop`].
    ///
    /// # Errors
    /// A loop name that already exists, an unknown frame, placements that are not rigid, or a loop that no
    /// configuration closes.
    pub fn with_loop(self, closed: Loop) -> Result<Self, ModelError> {
        let mut builder = ModelBuilder::from_model(&self.model);
        builder.close(closed);
        Ok(Self {
            model: builder.build()?,
            ..self
        })
    }

    /// Removes the loops of the file, for example if they contradict each other.
    #[must_use]
    pub fn without_loops(mut self) -> Self {
        self.model = self.model.without_loops();
        self
    }
}

/// A parameter map in which all joints are free except mimic joints.
#[doc(hidden)]
pub fn coupled<'m>(model: &'m Model, mimics: &[Mimic]) -> ParameterMapBuilder<'m> {
    let free = ParameterMap::builder(model);
    mimics.iter().fold(free, |map, mimic| {
        map.with_coupled(mimic.joint, mimic.master, mimic.ratio, mimic.offset)
    })
}
