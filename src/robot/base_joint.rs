//! What a robot's root link moves on.

use super::{Mimic, Robot};
use crate::model::{JointId, Limits, ModelBuilder, ModelError};
use crate::spatial::{Placement, Vector3};

/// The name of the joint that is put under a robot, or what its parts' names begin with.
const NAME: &str = "root_joint";

/// How the root of a robot moves in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum BaseJoint {
    /// It does not.
    Fixed,
    /// Any way, as a humanoid's pelvis does: x, y, z within `room` (metres) and a unit quaternion, which begin
    /// the configuration. Its joints are `root_joint/x`, `root_joint/y`, `root_joint/z` and
    /// `root_joint/rotation`.
    Free {
        /// Where it may stand.
        room: [Limits; 3],
    },
    /// On the ground, as a mobile base does: x and y within `room` (metres) and a turn about z within `yaw`
    /// (radians). Its joints are `root_joint/x`, `root_joint/y` and `root_joint/yaw`.
    Planar {
        /// Where it may stand.
        room: [Limits; 2],
        /// How far it may turn.
        yaw: Limits,
    },
    /// On a rail: `root_joint` slides along `axis`, of any length but zero, within `limits` (metres).
    Sliding {
        /// The rail's direction in the world.
        axis: Vector3<f64>,
        /// Where on it it may stand.
        limits: Limits,
    },
}

impl BaseJoint {
    /// Any way and anywhere.
    pub const FREE: Self = Self::Free {
        room: [Limits::UNBOUNDED; 3],
    };

    /// Anywhere on the ground, turned any way about z.
    pub const PLANAR: Self = Self::Planar {
        room: [Limits::UNBOUNDED; 2],
        yaw: Limits::UNBOUNDED,
    };

    fn add_to(self, builder: &mut ModelBuilder) -> Option<JointId> {
        let at = Placement::identity();
        match self {
            Self::Fixed => None,
            Self::Free { room } => Some(builder.free(NAME, None, at, room)),
            Self::Planar { room, yaw } => {
                let up = Vector3::UNITS[2];
                Some(builder.planar(NAME, None, at, up, room, yaw))
            }
            Self::Sliding { axis, limits } => Some(builder.prismatic(NAME, None, at, axis, limits)),
        }
    }
}

impl Robot {
    /// The same robot on a joint that moves the whole of it: everything that stood in the world stands on
    /// that. Frames keep their ids; joints get new ones, and those of the base come first in a configuration.
    ///
    /// ```
    /// # #[cfg(feature = "urdf")] {
    /// # use kinopt::robot::{BaseJoint, Robot};
    /// let robot = Robot::read("models/universal_ur5e.urdf")?.with_base_joint(BaseJoint::FREE)?;
    /// assert_eq!(robot.model().configuration_len(), 7 + 6);
    /// assert_eq!(robot.model().degrees_of_freedom(), 6 + 6);
    /// # }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// A room that is none, an axis without direction, or a robot that has a joint of that name.
    pub fn with_base_joint(self, base: BaseJoint) -> Result<Self, ModelError> {
        let before = self.model.joints().len();
        let builder = ModelBuilder::on_base(&self.model, |builder| base.add_to(builder));
        let model = builder.build()?;
        let added = model.joints().len() - before;
        let moved = |joint: JointId| JointId::new(joint.index() + added);
        let mimics = self.mimics.iter().map(|mimic| Mimic {
            joint: moved(mimic.joint),
            master: moved(mimic.master),
            ..*mimic
        });
        let mimics: Vec<Mimic> = mimics.collect();
        let mut drives = vec![super::Drive::default(); added];
        drives.extend(self.drives);
        let map = super::coupled(&model, &mimics).build()?;
        let passive = self.passive.iter().copied().map(moved).collect();
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
