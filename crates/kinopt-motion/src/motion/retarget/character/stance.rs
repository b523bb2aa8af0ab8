//! Places of hips and free feet of a character whose legs have other proportions.
//!
//! Thigh and shin have the subject's directions only if the ankle is where these directions bring it. Free feet are there.
//! For feet in contact the hips move instead.

use glam::DVec3;

use super::pose::BonePose;
use super::proportions::LEGS;
use super::transfer::{CharacterTransfer, FootTarget, SubjectFrame};
use crate::motion::contact::smooth;

/// Weight of a free foot in the shift of the hips; a foot in contact has the weight 1 more.
const FREE_FOOT_WEIGHT: f64 = 0.1;
/// Height of a free ankle above its height in contact from which the leg keeps its directions, relative to the leg.
const FREE_HEIGHT: f64 = 0.3;
/// Heights of the hips between which the shift begins, relative to the leg. The hips of a lying body keep their height.
const SHIFTED_HIPS: [f64; 2] = [0.25, 0.5];

impl CharacterTransfer {
    /// Offset of the hips that brings the feet of the subject's directions to their scaled places. Feet in contact count.
    pub(super) fn hip_shift(
        &self,
        frame: SubjectFrame<'_>,
        feet: &[Option<FootTarget>; 2],
        pose: &BonePose,
    ) -> DVec3 {
        let (mut sum, mut weights, mut lowest_hip) = (DVec3::ZERO, 0.0, f64::INFINITY);
        for ([hip, _, ankle, _], target) in LEGS.iter().zip(feet) {
            let (Some(target), Some(place), Some(hip), Some(bone)) = (
                target,
                self.foot_place(*ankle, frame),
                self.bone(*hip),
                self.bone(*ankle),
            ) else {
                continue;
            };
            let weight = target.contact_level + FREE_FOOT_WEIGHT;
            sum += (place - pose.positions[bone]) * weight;
            weights += weight;
            lowest_hip = lowest_hip.min(pose.positions[hip].z);
        }
        if weights == 0.0 {
            return DVec3::ZERO;
        }
        let [from, to] = SHIFTED_HIPS.map(|height| height * self.sizes.leg);
        let share = ((lowest_hip - from) / (to - from)).clamp(0.0, 1.0);
        sum / weights * smooth(share)
    }

    /// Returns the targets of the feet, with free feet where the subject's directions bring them.
    pub(super) fn with_free_feet(
        &self,
        feet: &[Option<FootTarget>; 2],
        pose: &BonePose,
    ) -> [Option<FootTarget>; 2] {
        std::array::from_fn(|leg| {
            let target = feet[leg]?;
            let ankle = LEGS[leg][2];
            let Some(bone) = self.bone(ankle) else {
                return Some(target);
            };
            let height = target.ankle.z - self.clearance(ankle);
            let height = (height / (FREE_HEIGHT * self.sizes.leg)).clamp(0.0, 1.0);
            let level = target.contact_level.max(1.0 - smooth(height));
            let offset = (pose.positions[bone] - target.ankle) * (1.0 - level);
            Some(FootTarget {
                ankle: target.ankle + offset,
                toe: target.toe.map(|toe| toe + offset),
                ..target
            })
        })
    }
}
