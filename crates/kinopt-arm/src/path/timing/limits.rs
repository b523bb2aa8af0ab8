//! Limits and options of path timing.

use super::tool_motion::ToolLimits;
use crate::arm::Arm;
use crate::path::PathError;
use kinopt_kinematics::bad_option::{ABOVE_0, BadOption, NOT_NEGATIVE, Range};

/// Allowed number of grid points.
const GRID_POINTS: Range = (|v| (2.0..=1e6).contains(&v), "a number from 2 to 1000000");

/// Limits and options of path timing.
///
/// Joint limits have one number per joint, in radians or metres and seconds. Infinity means no limit. In every step, at
/// least one moving joint needs a finite acceleration limit.
#[derive(Clone, Debug)]
pub struct TimingLimits<'a> {
    pub(super) velocity: Vec<f64>,
    pub(super) acceleration: Vec<f64>,
    pub(super) jerk: Option<Vec<f64>>,
    pub(super) tool: ToolLimits,
    pub(super) arm: Option<&'a Arm>,
    joint_names: Vec<String>,
    pub(super) corner_tolerance: f64,
    pub(super) grid_points: usize,
    pub(super) unreached_allowed: bool,
}

impl<'a> TimingLimits<'a> {
    /// Creates limits from joint velocities and accelerations, with default options.
    #[must_use]
    pub fn new(velocity_limits: &[f64], acceleration_limits: &[f64]) -> Self {
        Self {
            velocity: velocity_limits.to_vec(),
            acceleration: acceleration_limits.to_vec(),
            jerk: None,
            tool: ToolLimits::NONE,
            arm: None,
            joint_names: Vec::new(),
            corner_tolerance: 1e-3,
            grid_points: 1000,
            unreached_allowed: false,
        }
    }

    /// Creates limits from an arm's velocity and acceleration limits. Errors then name its joints.
    #[must_use]
    pub fn of(arm: &'a Arm) -> Self {
        Self::new(arm.velocity_limits(), arm.acceleration_limits()).with_arm(arm)
    }

    /// Sets the joint velocity limits, rad/s or m/s.
    #[must_use]
    pub fn with_velocity_limits(mut self, limits: &[f64]) -> Self {
        self.velocity = limits.to_vec();
        self
    }

    /// Sets the joint acceleration limits, rad/s² or m/s².
    #[must_use]
    pub fn with_acceleration_limits(mut self, limits: &[f64]) -> Self {
        self.acceleration = limits.to_vec();
        self
    }

    /// Sets the joint jerk limits, rad/s³ or m/s³.
    ///
    /// Without jerk limits accelerations are discontinuous. With jerk limits motions start and end with
    /// acceleration 0.
    #[must_use]
    pub fn with_jerk_limits(mut self, limits: &[f64]) -> Self {
        self.jerk = Some(limits.to_vec());
        self
    }

    /// Sets the arm of the tool limits, whose joint names also appear in errors.
    #[must_use]
    pub fn with_arm(mut self, arm: &'a Arm) -> Self {
        self.arm = Some(arm);
        self.joint_names = arm.joints().map(str::to_owned).collect();
        self
    }

    /// Sets the joint names in errors. The default is the indices.
    #[must_use]
    pub fn with_joint_names(mut self, names: &[String]) -> Self {
        self.joint_names = names.to_vec();
        self
    }

    /// Sets the largest speed (m/s) and acceleration (m/s²) of the tool origin; infinity for none. Needs
    /// [`with_arm`](Self::with_arm).
    #[must_use]
    pub fn with_tool_linear_limits(mut self, speed: f64, acceleration: f64) -> Self {
        self.tool.velocity[0] = speed;
        self.tool.acceleration[0] = acceleration;
        self
    }

    /// Sets the largest angular speed (rad/s) and acceleration (rad/s²) of the tool; infinity for none. Needs
    /// [`with_arm`](Self::with_arm).
    #[must_use]
    pub fn with_tool_angular_limits(mut self, speed: f64, acceleration: f64) -> Self {
        self.tool.velocity[1] = speed;
        self.tool.acceleration[1] = acceleration;
        self
    }

    /// Sets the largest distance of any joint from the path at a blended corner, radians or metres. Default 1e-3.
    ///
    /// With 0 the arm stops at every corner. It always stops at reversals of the path.
    #[must_use]
    pub fn with_corner_tolerance(mut self, distance: f64) -> Self {
        self.corner_tolerance = distance;
        self
    }

    /// Sets whether paths with [unreached rows](crate::arm::JointPath::unreached) are timed. Default false: they are an
    /// error, because the arm would miss points of its path or collide.
    #[must_use]
    pub fn with_unreached_allowed(mut self, allowed: bool) -> Self {
        self.unreached_allowed = allowed;
        self
    }

    /// Sets the number of grid points of the speed profile over the whole path. Default 1000. Curve knots and stops
    /// add some.
    #[must_use]
    pub fn with_grid_points(mut self, count: usize) -> Self {
        self.grid_points = count;
        self
    }

    /// Checks all options against the number of joints.
    pub(super) fn check(&self, joints: usize) -> Result<(), PathError> {
        if let Some(arm) = self.arm
            && arm.joint_count() != joints
        {
            return Err(PathError::Limits {
                option: "the arm's joints",
                given: arm.joint_count(),
                joints,
            });
        }
        let jerk = self.jerk.as_deref();
        let joint_limits = [
            ("velocity_limits", Some(&*self.velocity)),
            ("acceleration_limits", Some(&*self.acceleration)),
            ("jerk_limits", jerk),
        ];
        for (option, limits) in joint_limits {
            let Some(limits) = limits else { continue };
            if limits.len() != joints {
                return Err(PathError::Limits {
                    option,
                    given: limits.len(),
                    joints,
                });
            }
            let (is_allowed, allowed) = ABOVE_0;
            for (joint, &value) in limits.iter().enumerate() {
                if !is_allowed(value) {
                    return Err(PathError::JointLimit {
                        option,
                        joint: self.joint_name(joint),
                        value,
                        allowed,
                    });
                }
            }
        }
        let [linear_speed, angular_speed] = self.tool.velocity;
        let [linear_acceleration, angular_acceleration] = self.tool.acceleration;
        for (option, value) in [
            ("tool_linear_speed", linear_speed),
            ("tool_linear_acceleration", linear_acceleration),
            ("tool_angular_speed", angular_speed),
            ("tool_angular_acceleration", angular_acceleration),
        ] {
            BadOption::check(option, value, ABOVE_0)?;
        }
        BadOption::check("corner_tolerance", self.corner_tolerance, NOT_NEGATIVE)?;
        BadOption::check("grid_points", self.grid_points as f64, GRID_POINTS)?;
        if self.tool != ToolLimits::NONE && self.arm.is_none() {
            return Err(PathError::Conflict(
                "limits of the tool need the arm (`TimingLimits::with_arm`; Python: `arm=`)",
            ));
        }
        Ok(())
    }

    /// Returns the name of a joint for messages, or its index.
    pub(super) fn joint_name(&self, joint: usize) -> String {
        let name = self.joint_names.get(joint);
        name.map_or_else(
            || format!("joint {joint}"),
            |name| format!("joint `{name}`"),
        )
    }
}
