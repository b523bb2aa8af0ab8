//! Velocity, acceleration and jerk limits of an arm's joints.

use super::mechanism::Mechanism;
use super::serial_chain::{Serial, source_of};
use crate::model::{Model, ParameterMap};

/// Limits of joints, one number a joint.
#[derive(Clone, Debug)]
pub(super) struct RateLimits<T> {
    /// rad/s or m/s.
    pub(super) velocity: Vec<T>,
    /// rad/s² or m/s².
    pub(super) acceleration: Vec<T>,
    /// rad/s³ or m/s³.
    pub(super) jerk: Vec<T>,
}

impl RateLimits<Option<f64>> {
    /// By the ids of the joints; `None` for none.
    pub(super) fn of(mechanism: &impl Mechanism) -> Self {
        let joints = || mechanism.model().joint_ids();
        Self {
            velocity: joints().map(|id| mechanism.velocity_limit(id)).collect(),
            acceleration: joints()
                .map(|id| mechanism.acceleration_limit(id))
                .collect(),
            jerk: joints().map(|id| mechanism.jerk_limit(id)).collect(),
        }
    }

    /// Of an arm's free joints, base to tip, infinite for none: a joint's own, and those of the joints that follow it.
    pub(super) fn of_free_joints(
        &self,
        model: &Model,
        full: &ParameterMap,
        serial: &Serial,
    ) -> RateLimits<f64> {
        let least = |limits: &[Option<f64>]| {
            let mut least = vec![f64::INFINITY; serial.joints.len()];
            for (coordinate, id) in model.moving_joints().iter().enumerate() {
                let limit = limits.get(id.index()).copied().flatten();
                if let (Some((variable, ratio)), Some(limit)) =
                    (source_of(full, coordinate).slope(), limit)
                {
                    let leader = model.moving_joints()[full.leaders()[variable]];
                    let own = serial.joints.iter().position(|joint| *joint == leader);
                    if let Some(known) = own.and_then(|own| least.get_mut(own)) {
                        *known = known.min((limit / ratio).abs());
                    }
                }
            }
            least
        };
        RateLimits {
            velocity: least(&self.velocity),
            acceleration: least(&self.acceleration),
            jerk: least(&self.jerk),
        }
    }
}
