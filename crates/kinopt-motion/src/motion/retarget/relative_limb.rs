//! Limbs that follow the vector from their parent.
//!
//! The shoulders of a robot are seldom where those of a scaled subject are. Absolute targets of elbows and hands would
//! turn that distance into a wrong direction of the arm.

use super::limb::DrivenLimb;
use super::point_difference::PointDifference;

/// Weight of the absolute position of a limb that follows the vector from its parent, relative to the limb's weight.
const ABSOLUTE_SHARE: f64 = 0.1;

/// Returns whether a limb follows the vector from its parent: those that neither make contact nor begin at the root.
fn is_relative(all: &[DrivenLimb], limb: usize) -> bool {
    let parent = all[limb].parent.map(|parent| &all[parent]);
    let begins_at_root = parent.is_none_or(|parent| parent.parent.is_none());
    !begins_at_root
        && !all[limb].makes_contact
        && parent.is_some_and(|parent| parent.frame != all[limb].frame)
}

/// Returns the task of a limb's vector from its parent; `None` for one without.
pub(super) fn task(all: &[DrivenLimb], limb: usize) -> Option<PointDifference> {
    let ends = [limb, all[limb].parent.filter(|_| is_relative(all, limb))?];
    let (frames, offsets) = (ends.map(|k| all[k].frame), ends.map(|k| all[k].offset));
    Some(PointDifference::new(frames, offsets, all[limb].weight))
}

/// Returns the weight of a limb's absolute position.
pub(super) fn point_weight(all: &[DrivenLimb], limb: usize) -> f64 {
    match is_relative(all, limb) {
        true => ABSOLUTE_SHARE * all[limb].weight,
        false => all[limb].weight,
    }
}
