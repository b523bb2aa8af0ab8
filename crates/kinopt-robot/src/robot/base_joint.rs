//! Base joints: the joint between the world and the root link of a robot.

use super::Robot;
use kinopt_kinematics::model::{JointId, Limits, ModelBuilder, ModelError, UnknownName};
use kinopt_kinematics::spatial::{Placement, Vector3};

/// Name of the base joint, and prefix of the names of its parts.
const BASE_JOINT_NAME: &str = "root_joint";

/// Motion of a robot's root link in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum BaseJoint {
    /// The root link is fixed in the world.
    Fixed,
    /// Six degrees of freedom, as of a humanoid's pelvis: x, y and z (metres) and a unit quaternion. They come first in
    /// the configuration.
    ///
    /// The joints are `root_joint/x`, `root_joint/y`, `root_joint/z` and `root_joint/rotation`.
    Free {
        /// Bounds of x, y and z, metres.
        room: [Limits; 3],
    },
    /// Planar motion on the ground, as of a mobile base: x and y (metres) and a rotation about z (radians).
    ///
    /// The joints are `root_joint/x`, `root_joint/y` and `root_joint/yaw`.
    Planar {
        /// Bounds of x and y, metres.
        room: [Limits; 2],
        /// Bounds of the rotation about z, radians.
        yaw: Limits,
    },
    /// A linear rail: the prismatic joint `root_joint`. `axis` may have any length but zero.
    Sliding {
        /// Direction of the rail in the world.
        axis: Vector3<f64>,
        /// Bounds of the position along the rail, metres.
        limits: Limits,
    },
}

impl BaseJoint {
    /// Six degrees of freedom without bounds.
    pub const FREE: Self = Self::Free {
        room: [Limits::UNBOUNDED; 3],
    };

    /// Planar motion without bounds.
    pub const PLANAR: Self = Self::Planar {
        room: [Limits::UNBOUNDED; 2],
        yaw: Limits::UNBOUNDED,
    };

    /// Names of the kinds of base joints. `slide-x`, `slide-y` and `slide-z` are rails along the axes of the world.
    pub const KINDS: [&'static str; 6] =
        ["fixed", "free", "planar", "slide-x", "slide-y", "slide-z"];

    /// Creates the base joint of a [kind](Self::KINDS), with bounds along the axes on which it moves.
    ///
    /// The axes are `x`, `y` and `z` (metres), and for `planar` also `yaw` (radians). Axes without a range are
    /// unbounded. Two ranges of one axis are intersected.
    ///
    /// ```
    /// # use kinopt::model::Limits;
    /// # use kinopt::robot::BaseJoint;
    /// let rail = BaseJoint::named("slide-y", [("y", Limits::new(-1.0, 1.0))])?;
    /// assert!(matches!(rail, BaseJoint::Sliding { limits, .. } if limits.upper == 1.0));
    /// let error = BaseJoint::named("planar", [("z", Limits::new(0.0, 1.0))]).unwrap_err();
    /// assert_eq!(error.valid, ["x", "y", "yaw"]);
    /// # Ok::<(), kinopt::model::UnknownName>(())
    /// ```
    ///
    /// # Errors
    /// An unknown kind, or an axis on which the base does not move. The error lists the valid names.
    pub fn named<A: AsRef<str>>(
        kind: &str,
        ranges: impl IntoIterator<Item = (A, Limits)>,
    ) -> Result<Self, UnknownName> {
        const AXES: [&str; 4] = ["x", "y", "z", "yaw"];
        let index = Self::KINDS.iter().position(|index| *index == kind);
        let kind = index.ok_or_else(|| UnknownName::new("base joint", kind, Self::KINDS))?;
        let axes: &[usize] = [&[][..], &[0, 1, 2], &[0, 1, 3], &[0], &[1], &[2]][kind];
        let mut bounds = [Limits::UNBOUNDED; 4];
        for (axis, range) in ranges {
            let axis = axis.as_ref();
            let index = axes.iter().find(|&&index| AXES[index] == axis);
            let valid = axes.iter().map(|&index| AXES[index]);
            let index = index.ok_or_else(|| UnknownName::new("axis of this base", axis, valid))?;
            // Limits that are NaN stay NaN, so that the model builder reports them.
            let limits = &mut bounds[*index];
            let is_invalid = |limits: &Limits| limits.lower.is_nan() || limits.upper.is_nan();
            match (is_invalid(limits), is_invalid(&range)) {
                (true, _) => {}
                (_, true) => *limits = range,
                _ => *limits = limits.intersection(&range),
            }
        }
        let [x, y, z, yaw] = bounds;
        Ok(match kind {
            0 => Self::Fixed,
            1 => Self::Free { room: [x, y, z] },
            2 => Self::Planar { room: [x, y], yaw },
            slide => Self::Sliding {
                axis: Vector3::UNITS[slide - 3],
                limits: bounds[slide - 3],
            },
        })
    }

    fn add_to(self, builder: &mut ModelBuilder) -> Option<JointId> {
        let placement = Placement::identity();
        match self {
            Self::Fixed => None,
            Self::Free { room: bounds } => {
                Some(builder.free(BASE_JOINT_NAME, None, placement, bounds))
            }
            Self::Planar { room: bounds, yaw } => {
                let up = Vector3::UNITS[2];
                Some(builder.planar(BASE_JOINT_NAME, None, placement, up, bounds, yaw))
            }
            Self::Sliding { axis, limits } => {
                Some(builder.prismatic(BASE_JOINT_NAME, None, placement, axis, limits))
            }
        }
    }
}

impl Robot {
    /// Puts the robot on a base joint that moves it as a whole. All joints and links that are fixed to the world become
    /// children of the base joint.
    ///
    /// Frames keep their ids. Joints get new ids, and the base joints come first in the configuration.
    ///
    /// A robot whose file already has a free joint at the root, as most MJCF files do, keeps that joint as its free
    /// base. The joint keeps its name, gets the bounds and comes first in the configuration. All joints keep their ids.
    ///
    /// ```
    /// # std::env::set_current_dir("../..")?;
    /// # use kinopt::robot::{BaseJoint, Robot};
    /// let robot = Robot::read("models/universal_ur5e.urdf")?.with_base_joint(BaseJoint::FREE)?;
    /// assert_eq!(robot.model().configuration_len(), 7 + 6);
    /// assert_eq!(robot.model().degrees_of_freedom(), 6 + 6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Invalid bounds, an axis of zero length, or a joint name that already exists. Also a planar or sliding base for a
    /// robot with a free root joint.
    pub fn with_base_joint(self, base: BaseJoint) -> Result<Self, ModelError> {
        match (base, self.free_root()) {
            (BaseJoint::Fixed, _) | (_, None) => self.on_base(base),
            (BaseJoint::Free { room: bounds }, Some(first)) => {
                self.with_bounded_root(first, bounds)
            }
            (_, Some(first)) => Err(ModelError::FreeAlready {
                joint: self.model.joints()[first.index()].name.clone(),
                model: self.model.name().to_owned(),
            }),
        }
    }

    /// Reports whether a joint translates all moving parts: a free, planar or sliding base, from the file or from
    /// [`with_base_joint`](Self::with_base_joint).
    #[must_use]
    pub fn moves_as_a_whole(&self) -> bool {
        let joints = self.model.joints();
        let mut carrying = self.carrying_joints();
        carrying.any(|id| joints[id.index()].kind.slides())
    }

    /// The first translation joint of the free root joint, if the robot has one.
    #[must_use]
    pub fn free_root(&self) -> Option<JointId> {
        let free = self.model.free_joints();
        self.carrying_joints().find(|id| free.contains(id))
    }

    /// The moving joints that carry all moving joints; a joint carries itself.
    fn carrying_joints(&self) -> impl Iterator<Item = JointId> {
        let joints = self.model.joints();
        let parent = |id: &JointId| joints[id.index()].parent;
        let is_carried_by =
            move |id: &JointId, root| std::iter::successors(Some(*id), parent).any(|on| on == root);
        let moving = self.model.moving_joints();
        let carries = move |root: &JointId| moving.iter().all(|id| is_carried_by(id, *root));
        moving.iter().copied().filter(carries)
    }

    /// The robot with bounds on its free root joint, which comes first in the configuration.
    fn with_bounded_root(self, first: JointId, bounds: [Limits; 3]) -> Result<Self, ModelError> {
        let mut builder = ModelBuilder::from_model(&self.model);
        let mut order = self.model.moving_joints().to_vec();
        order.dedup();
        // A free joint is four consecutive joints: three translations and a ball.
        let end = order.iter().take_while(|id| **id != first).count() + 4;
        if let Some(up_to_root) = order.get_mut(..end) {
            up_to_root.rotate_right(4);
        }
        for (joint, limits) in order.iter().zip(bounds) {
            builder.narrow(*joint, limits);
        }
        builder.configuration_order(order);
        let model = builder.build()?;
        let map = super::coupled(&model, &self.mimics.joints).build()?;
        Ok(Self { model, map, ..self })
    }

    /// The robot on an added base joint.
    fn on_base(self, base: BaseJoint) -> Result<Self, ModelError> {
        let old_count = self.model.joints().len();
        let builder = ModelBuilder::on_base(&self.model, |builder| base.add_to(builder));
        let model = builder.build()?;
        let added = model.joints().len() - old_count;
        let shifted_id = |joint: JointId| JointId::new(joint.index() + added);
        let mut mimics = self.mimics;
        for mimic in &mut mimics.joints {
            mimic.joint = shifted_id(mimic.joint);
            mimic.master = shifted_id(mimic.master);
        }
        let mut drives = vec![super::DriveLimits::default(); added];
        drives.extend(self.drives);
        let map = super::coupled(&model, &mimics.joints).build()?;
        let passive = self.passive.iter().copied().map(shifted_id).collect();
        Ok(Self {
            model,
            mimics,
            map,
            drives,
            passive,
            ..self
        })
    }
}
