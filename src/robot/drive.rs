//! What moves a joint, as far as files tell it: speed, effort, soft limits.

use super::{Robot, mimic};
use crate::ik::MotionLimits;
use crate::model::{JointId, Limits, ModelError};

/// Limits of a joint's drive.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Drive {
    /// rad/s or m/s.
    pub(super) velocity: Option<f64>,
    /// rad/s² or m/s².
    pub(super) acceleration: Option<f64>,
    /// rad/s³ or m/s³.
    pub(super) jerk: Option<f64>,
    /// N·m or N.
    pub(super) effort: Option<f64>,
    /// Radians or metres.
    pub(super) soft_limits: Option<Limits>,
}

impl Robot {
    /// How fast a joint may move, in rad/s or m/s: `velocity` of its `<limit>` in the file. `None`
    /// where the file states none, for fixed joints and for ids beyond this robot's joints.
    ///
    /// A `velocity` of 0 or less is `None` too: URDF demands the attribute, and files that know no
    /// speed write 0; a joint that cannot move at all is a fixed one.
    ///
    /// ```
    /// # use kinopt::robot::Robot;
    /// let robot = Robot::read("models/universal_ur5e.urdf")?;
    /// let wrist = robot.model().joint("joint6")?;
    /// assert_eq!(robot.velocity_limit(wrist), Some(std::f64::consts::PI));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn velocity_limit(&self, joint: JointId) -> Option<f64> {
        self.drives.get(joint.index())?.velocity
    }

    /// How far each joint gets in a time, in radians or metres: its [`velocity_limit`](Self::velocity_limit) times
    /// `seconds`, one for every number of a configuration, infinity for what has no limit. For
    /// [`MoveLimits::new`](crate::ik::MoveLimits::new), which refuses what a negative time makes of it. A ball turns by
    /// the angle; a free joint's slides and ball each have their own.
    #[must_use]
    pub fn moves_within(&self, seconds: f64) -> Vec<f64> {
        let joints = self.model.moving_joints().iter();
        let speeds = joints.map(|&joint| self.velocity_limit(joint));
        let moves = speeds.map(|speed| speed.map_or(f64::INFINITY, |speed| speed * seconds));
        moves.collect()
    }

    /// Acceleration limit of a joint, rad/s² or m/s²: `acceleration` of a URDF's `<limit>` (URDF 1.2), or `max_acceleration` of a
    /// [`joint_limits.yaml`](Self::with_joint_limits). `None` as for [`velocity_limit`](Self::velocity_limit).
    #[must_use]
    pub fn acceleration_limit(&self, joint: JointId) -> Option<f64> {
        self.drives.get(joint.index())?.acceleration
    }

    /// Jerk limit of a joint, rad/s³ or m/s³: `jerk` of a URDF's `<limit>` (URDF 1.2), or `max_jerk` of a
    /// [`joint_limits.yaml`](Self::with_joint_limits). `None` as for [`velocity_limit`](Self::velocity_limit).
    #[must_use]
    pub fn jerk_limit(&self, joint: JointId) -> Option<f64> {
        self.drives.get(joint.index())?.jerk
    }

    /// Velocity, acceleration and jerk limits of the robot's files, for
    /// [`Drag::with_motion_limits`](crate::ik::Drag::with_motion_limits). Infinite for joints without one, such as a free base: set its
    /// numbers, the first three linear, the next four angular.
    #[must_use]
    pub fn motion_limits(&self) -> MotionLimits {
        let of = |limit: fn(&Self, JointId) -> Option<f64>| -> Vec<f64> {
            let joints = self.model.moving_joints().iter();
            let limits = joints.map(|&joint| limit(self, joint).unwrap_or(f64::INFINITY));
            limits.collect()
        };
        MotionLimits::unlimited(self.model.configuration_len())
            .with_velocity(of(Self::velocity_limit))
            .with_acceleration(of(Self::acceleration_limit))
            .with_jerk(of(Self::jerk_limit))
    }

    /// How hard a joint may push, in N·m or N: `effort` of its `<limit>` in the file. `None` as for
    /// [`velocity_limit`](Self::velocity_limit).
    #[must_use]
    pub fn effort_limit(&self, joint: JointId) -> Option<f64> {
        self.drives.get(joint.index())?.effort
    }

    /// The range in which the joint's own safety controller leaves it alone, in radians or metres:
    /// `<safety_controller>` in the file, unbounded on a side that it does not give. `None` where it
    /// gives neither. It binds nothing unless [`with_soft_limits`](Self::with_soft_limits) is asked
    /// for.
    #[must_use]
    pub fn soft_limits(&self, joint: JointId) -> Option<Limits> {
        self.drives.get(joint.index())?.soft_limits
    }

    /// The same robot with every joint also within its [`soft_limits`](Self::soft_limits), where a
    /// real robot's controller would stop or push it back.
    ///
    /// # Errors
    /// The first joint whose soft limits leave it no value, or whose followers do.
    pub fn with_soft_limits(self) -> Result<Self, ModelError> {
        let soft = |joint| Some((joint, self.soft_limits(joint)?));
        let narrowed: Vec<_> = self.model.joint_ids().filter_map(soft).collect();
        self.narrowed(&narrowed)
    }

    /// The same robot with joints also within these limits.
    pub(super) fn narrowed(self, limits: &[(JointId, Limits)]) -> Result<Self, ModelError> {
        let mut mimics = self.mimics;
        let mut builder = mimics.with_ranges_of_files(&self.model);
        for &(joint, limits) in limits {
            builder.narrow(joint, limits);
        }
        let model = builder.build()?;
        mimics.ranges = mimic::ranges(&model, &mimics.joints);
        let (model, map) = mimics.applied(model)?;
        Ok(Self {
            model,
            mimics,
            map,
            ..self
        })
    }
}
