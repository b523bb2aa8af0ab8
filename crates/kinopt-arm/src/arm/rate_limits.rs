//! Velocity, acceleration and jerk limits of an arm's joints.

use super::arm_model::ArmModel;
use super::serial_chain::{Serial, source_of};
use kinopt_kinematics::model::{Model, ParameterMap};

/// Limits of joints, one number per joint.
#[derive(Clone, Debug)]
pub(super) struct RateLimits<T> {
    /// Velocity limits, rad/s or m/s.
    pub(super) velocity: Vec<T>,
    /// Acceleration limits, rad/s² or m/s².
    pub(super) acceleration: Vec<T>,
    /// Jerk limits, rad/s³ or m/s³.
    pub(super) jerk: Vec<T>,
}

impl RateLimits<Option<f64>> {
    /// Limits of the model's joints in the order of their ids; `None` for no limit.
    pub(super) fn of(arm_model: &impl ArmModel) -> Self {
        let joints = || arm_model.model().joint_ids();
        Self {
            velocity: joints().map(|id| arm_model.velocity_limit(id)).collect(),
            acceleration: joints()
                .map(|id| arm_model.acceleration_limit(id))
                .collect(),
            jerk: joints().map(|id| arm_model.jerk_limit(id)).collect(),
        }
    }

    /// Limits of an arm's free joints, base to tip; infinite for none.
    ///
    /// They include the limits of the mimic joints that a free joint drives.
    pub(super) fn of_free_joints(
        &self,
        model: &Model,
        full: &ParameterMap,
        serial: &Serial,
    ) -> RateLimits<f64> {
        let min_limits = |limits: &[Option<f64>]| {
            let mut min_limits = vec![f64::INFINITY; serial.joints.len()];
            for (coordinate, id) in model.moving_joints().iter().enumerate() {
                let limit = limits.get(id.index()).copied().flatten();
                if let (Some((variable, ratio)), Some(limit)) =
                    (source_of(full, coordinate).slope(), limit)
                {
                    let source_joint = model.moving_joints()[full.leaders()[variable]];
                    let index = serial
                        .joints
                        .iter()
                        .position(|joint| *joint == source_joint);
                    if let Some(min_limit) = index.and_then(|index| min_limits.get_mut(index)) {
                        *min_limit = min_limit.min((limit / ratio).abs());
                    }
                }
            }
            min_limits
        };
        RateLimits {
            velocity: min_limits(&self.velocity),
            acceleration: min_limits(&self.acceleration),
            jerk: min_limits(&self.jerk),
        }
    }
}
