//! Joint velocity, acceleration, jerk and effort limits, and soft limits.

use super::{Robot, mimic};
use kinopt_kinematics::model::{JointId, Limits, ModelError};
use kinopt_solver::ik::MotionLimits;

/// Limits of a joint's drive.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct DriveLimits {
    /// In rad/s or m/s.
    pub(super) velocity: Option<f64>,
    /// In rad/s² or m/s².
    pub(super) acceleration: Option<f64>,
    /// In rad/s³ or m/s³.
    pub(super) jerk: Option<f64>,
    /// In N·m or N.
    pub(super) effort: Option<f64>,
    /// In radians or metres.
    pub(super) soft_limits: Option<Limits>,
}

impl Robot {
    /// Velocity limit of a joint, rad/s or m/s: `velocity` of its `<limit>` in the file. `None` for joints without a
    /// limit, fixed joints and unknown ids.
    ///
    /// A `velocity` of 0 or less counts as no limit. URDF requires the attribute, and exporters that have no value
    /// write 0.
    ///
    /// ```
    /// # std::env::set_current_dir("../..")?;
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

    /// Largest displacement of each joint in `seconds`, radians or metres: its [`velocity_limit`](Self::velocity_limit)
    /// times `seconds`. [`MoveLimits::new`](kinopt_solver::ik::MoveLimits::new) takes the result, and rejects the negative
    /// values that a negative time gives.
    ///
    /// The length is that of a configuration. Joints without a limit have infinity. The displacement of a ball joint is
    /// its rotation angle. The translations and the ball of a free joint have separate limits.
    #[must_use]
    pub fn moves_within(&self, seconds: f64) -> Vec<f64> {
        let joints = self.model.moving_joints().iter();
        let speeds = joints.map(|&joint| self.velocity_limit(joint));
        let moves = speeds.map(|speed| speed.map_or(f64::INFINITY, |speed| speed * seconds));
        moves.collect()
    }

    /// Acceleration limit of a joint, rad/s² or m/s²: `acceleration` of a URDF's `<limit>` (URDF 1.2), or
    /// `max_acceleration` of a [`joint_limits.yaml`](Self::with_joint_limits). `None` as for
    /// [`velocity_limit`](Self::velocity_limit).
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

    /// Velocity, acceleration and jerk limits from the robot's files, for
    /// [`Drag::with_motion_limits`](kinopt_solver::ik::Drag::with_motion_limits).
    ///
    /// Joints without a limit, such as a free base, have infinity. Set the values of a free base directly: the first
    /// three are linear, the next four angular.
    #[must_use]
    pub fn motion_limits(&self) -> MotionLimits {
        let of_joints = |limit: fn(&Self, JointId) -> Option<f64>| -> Vec<f64> {
            let joints = self.model.moving_joints().iter();
            let limits = joints.map(|&joint| limit(self, joint).unwrap_or(f64::INFINITY));
            limits.collect()
        };
        MotionLimits::unlimited(self.model.configuration_len())
            .with_velocity(of_joints(Self::velocity_limit))
            .with_acceleration(of_joints(Self::acceleration_limit))
            .with_jerk(of_joints(Self::jerk_limit))
    }

    /// Effort limit of a joint, N·m or N: `effort` of its `<limit>` in the file. `None` as for
    /// [`velocity_limit`](Self::velocity_limit).
    #[must_use]
    pub fn effort_limit(&self, joint: JointId) -> Option<f64> {
        self.drives.get(joint.index())?.effort
    }

    /// Soft limits of a joint, radians or metres: the range outside which the joint's safety controller acts. They come
    /// from `<safety_controller>` in the file, unbounded on a side that the file does not state.
    ///
    /// `None` if the file states neither side. Soft limits have no effect unless
    /// [`with_soft_limits`](Self::with_soft_limits) is called.
    #[must_use]
    pub fn soft_limits(&self, joint: JointId) -> Option<Limits> {
        self.drives.get(joint.index())?.soft_limits
    }

    /// Narrows the limits of every joint to its [`soft_limits`](Self::soft_limits), at which the controller of a real
    /// robot stops the joint or pushes it back.
    ///
    /// # Errors
    /// The first joint whose soft limits, or those of its mimic joints, leave it no value.
    pub fn with_soft_limits(self) -> Result<Self, ModelError> {
        let soft = |joint| Some((joint, self.soft_limits(joint)?));
        let narrowed: Vec<_> = self.model.joint_ids().filter_map(soft).collect();
        self.narrowed(&narrowed)
    }

    /// Narrows the limits of the given joints.
    #[doc(hidden)]
    pub fn narrowed(self, limits: &[(JointId, Limits)]) -> Result<Self, ModelError> {
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
