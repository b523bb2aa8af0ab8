//! What a robot's root link moves on.

use super::Robot;
use crate::model::{JointId, Limits, ModelBuilder, ModelError, UnknownName};
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

    /// What it is called from outside: `fixed`, `free`, `planar`, or `slide-x` and its like along an axis of the
    /// world.
    pub const KINDS: [&'static str; 6] =
        ["fixed", "free", "planar", "slide-x", "slide-y", "slide-z"];

    /// The base joint of a [kind](Self::KINDS), within ranges along the axes on which it moves: `x`, `y` and `z` in
    /// metres, of a planar one `yaw` in radians. What no range is given for is anywhere; of two along one axis both count.
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
    /// An unknown kind, or an axis on which such a base does not move; the error tells those that there are.
    pub fn named<A: AsRef<str>>(
        kind: &str,
        ranges: impl IntoIterator<Item = (A, Limits)>,
    ) -> Result<Self, UnknownName> {
        const AXES: [&str; 4] = ["x", "y", "z", "yaw"];
        let known = Self::KINDS.iter().position(|known| *known == kind);
        let kind = known.ok_or_else(|| UnknownName::new("base joint", kind, Self::KINDS))?;
        let moves: &[usize] = [&[][..], &[0, 1, 2], &[0, 1, 3], &[0], &[1], &[2]][kind];
        let mut room = [Limits::UNBOUNDED; 4];
        for (axis, range) in ranges {
            let axis = axis.as_ref();
            let own = moves.iter().find(|&&own| AXES[own] == axis);
            let valid = moves.iter().map(|&own| AXES[own]);
            let own = own.ok_or_else(|| UnknownName::new("axis of this base", axis, valid))?;
            // One that is none stays so, for the builder to name.
            let own = &mut room[*own];
            let is_none = |limits: &Limits| limits.lower.is_nan() || limits.upper.is_nan();
            match (is_none(own), is_none(&range)) {
                (true, _) => {}
                (_, true) => *own = range,
                _ => *own = own.intersection(&range),
            }
        }
        let [x, y, z, yaw] = room;
        Ok(match kind {
            0 => Self::Fixed,
            1 => Self::Free { room: [x, y, z] },
            2 => Self::Planar { room: [x, y], yaw },
            slide => Self::Sliding {
                axis: Vector3::UNITS[slide - 3],
                limits: room[slide - 3],
            },
        })
    }

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
    /// A robot that a free joint of its own moves as a whole, as most MJCF files have one, has a free base: that one is
    /// taken, under its own name, within the room and first in a configuration, and joints keep their ids.
    ///
    /// ```
    /// # use kinopt::robot::{BaseJoint, Robot};
    /// let robot = Robot::read("models/universal_ur5e.urdf")?.with_base_joint(BaseJoint::FREE)?;
    /// assert_eq!(robot.model().configuration_len(), 7 + 6);
    /// assert_eq!(robot.model().degrees_of_freedom(), 6 + 6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// A room that is none, an axis without direction, a robot that has a joint of that name, or a planar or sliding
    /// base of one that moves freely.
    pub fn with_base_joint(self, base: BaseJoint) -> Result<Self, ModelError> {
        match (base, self.free_root()) {
            (BaseJoint::Fixed, _) | (_, None) => self.put_on(base),
            (BaseJoint::Free { room }, Some(first)) => self.keep_within(first, room),
            (_, Some(first)) => Err(ModelError::FreeAlready {
                joint: self.model.joints()[first.index()].name.clone(),
                model: self.model.name().to_owned(),
            }),
        }
    }

    /// Whether a joint slides everything that moves: a free, planar or sliding base, be it the file's own or
    /// [put under it](Self::with_base_joint).
    #[must_use]
    pub fn moves_as_a_whole(&self) -> bool {
        let joints = self.model.joints();
        let mut carrying = self.carrying_joints();
        carrying.any(|id| joints[id.index()].kind.slides())
    }

    /// The first slide of the free joint that everything that moves hangs on, if there is one.
    #[must_use]
    pub fn free_root(&self) -> Option<JointId> {
        let free = self.model.free_joints();
        self.carrying_joints().find(|id| free.contains(id))
    }

    /// The moving joints that everything that moves hangs on.
    fn carrying_joints(&self) -> impl Iterator<Item = JointId> {
        let joints = self.model.joints();
        let up = |id: &JointId| joints[id.index()].parent;
        let hangs =
            move |id: &JointId, root| std::iter::successors(Some(*id), up).any(|on| on == root);
        let moving = self.model.moving_joints();
        let carries = move |root: &JointId| moving.iter().all(|id| hangs(id, *root));
        moving.iter().copied().filter(carries)
    }

    /// The same robot whose own free joint stays within a room and comes first in a configuration.
    fn keep_within(self, first: JointId, room: [Limits; 3]) -> Result<Self, ModelError> {
        let mut builder = ModelBuilder::from_model(&self.model);
        let mut order = self.model.moving_joints().to_vec();
        order.dedup();
        // Its slides and its ball stand side by side.
        let end = order.iter().take_while(|id| **id != first).count() + 4;
        if let Some(to_base) = order.get_mut(..end) {
            to_base.rotate_right(4);
        }
        for (slide, limits) in order.iter().zip(room) {
            builder.narrow(*slide, limits);
        }
        builder.configuration_order(order);
        let model = builder.build()?;
        let map = super::coupled(&model, &self.mimics.joints).build()?;
        Ok(Self { model, map, ..self })
    }

    /// The same robot on one more joint.
    fn put_on(self, base: BaseJoint) -> Result<Self, ModelError> {
        let before = self.model.joints().len();
        let builder = ModelBuilder::on_base(&self.model, |builder| base.add_to(builder));
        let model = builder.build()?;
        let added = model.joints().len() - before;
        let moved = |joint: JointId| JointId::new(joint.index() + added);
        let mut mimics = self.mimics;
        for mimic in &mut mimics.joints {
            mimic.joint = moved(mimic.joint);
            mimic.master = moved(mimic.master);
        }
        let mut drives = vec![super::Drive::default(); added];
        drives.extend(self.drives);
        let map = super::coupled(&model, &mimics.joints).build()?;
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
