//! Joints whose whole revolutions are ignored.

use std::f64::consts::TAU;

use crate::arm::Arm;

/// Range beyond one revolution, radians, that keeps the half revolutions about the centre away from the limits.
const MIN_EXCESS_RANGE: f64 = 1.0;

/// Joints whose whole revolutions are ignored.
#[derive(Clone, Debug, Default)]
pub(super) struct Revolutions {
    /// Centre of each joint's range, if its revolutions are ignored.
    middles: Vec<Option<f32>>,
}

impl Revolutions {
    /// Ignores no revolutions.
    pub(super) fn counted(joints: usize) -> Self {
        Self {
            middles: vec![None; joints],
        }
    }

    /// Ignores the revolutions of all limited joints with a range of sufficiently more than one revolution.
    pub(super) fn ignored(arm: &Arm) -> Self {
        let joints = arm.limits().zip(arm.slides());
        let middles = joints.map(|(limits, slides)| {
            let range = limits.upper - limits.lower;
            let is_ignored = !slides && range.is_finite() && range >= TAU + MIN_EXCESS_RANGE;
            is_ignored.then_some(0.5 * (limits.lower + limits.upper) as f32)
        });
        Self {
            middles: middles.collect(),
        }
    }

    pub(super) fn any_ignored(&self) -> bool {
        self.middles.iter().any(Option::is_some)
    }

    pub(super) fn is_ignored(&self, joint: usize) -> bool {
        self.middles[joint].is_some()
    }

    /// Returns the displacement of a joint, without whole revolutions if these are ignored.
    pub(super) fn difference(&self, joint: usize, from: f32, to: f32) -> f32 {
        match self.middles[joint] {
            None => to - from,
            Some(_) => without_revolutions(to - from),
        }
    }

    /// Moves values to within half a revolution of the centre, if revolutions are ignored.
    pub(super) fn fold(&self, q: &mut [f32]) {
        for (value, middle) in q.iter_mut().zip(&self.middles) {
            if let Some(middle) = middle {
                *value = middle + without_revolutions(*value - middle);
            }
        }
    }
}

fn without_revolutions(angle: f32) -> f32 {
    let revolution = TAU as f32;
    angle - revolution * (angle / revolution).round()
}
