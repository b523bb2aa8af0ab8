//! Hierarchy of limbs.

use super::limbs::Limb;
use crate::model::{FrameId, JointId, Model};
use crate::spatial::Vector3;

/// Returns the joints from a frame up to the root.
pub(super) fn joints_above(model: &Model, frame: FrameId) -> Vec<JointId> {
    let mut above = model.frames()[frame.index()].joint;
    let joints = std::iter::from_fn(|| {
        let joint = above?;
        above = model.joints()[joint.index()].parent;
        Some(joint)
    });
    joints.collect()
}

/// Returns the joint that moves a frame, if there is one.
pub(super) fn moving_joint(model: &Model, frame: FrameId) -> Option<JointId> {
    let mut above = joints_above(model, frame).into_iter();
    above.find(|id| model.joints()[id.index()].kind.moves())
}

/// Returns the position of a limb's end in the frame of the joint that moves it.
fn from_moving_joint(model: &Model, limb: &Limb) -> Vector3<f64> {
    let frame = &model.frames()[limb.frame.index()];
    let mut at = frame.joint_from_frame.apply(limb.offset);
    let joints = joints_above(model, limb.frame).into_iter();
    for joint in joints.map(|id| &model.joints()[id.index()]) {
        if joint.kind.moves() {
            break;
        }
        at = joint.parent_from_joint.apply(at);
    }
    at
}

/// Sorts limbs parents first and sets their parents: the nearest driven frame towards the root, or the root limb.
pub(super) fn order(model: &Model, all: &mut [Limb]) {
    let moving = |limb: &Limb| {
        let above = joints_above(model, limb.frame);
        let moves = |joint: &JointId| model.joints()[joint.index()].kind.moves();
        above.into_iter().filter(moves).collect::<Vec<_>>()
    };
    // For equal chains the nearer end comes first: a knee before the ankle at the end of the shin.
    let off = |limb: &Limb| from_moving_joint(model, limb).norm();
    all.sort_by(|a, b| {
        let lengths = [a, b].map(|limb| moving(limb).len());
        let offs = [a, b].map(off);
        lengths[0]
            .cmp(&lengths[1])
            .then(offs[0].total_cmp(&offs[1]))
    });
    let chains: Vec<Vec<JointId>> = all.iter().map(moving).collect();
    for k in 1..all.len() {
        let carried_by = |other: &usize| {
            let tip = chains[*other].first();
            tip.is_some_and(|tip| chains[k].contains(tip))
        };
        all[k].parent = Some((0..k).rev().find(carried_by).unwrap_or(0));
    }
}

/// Returns the limbs between contact points and the root, without hips and feet. Without the flag, returns the limbs of
/// all ends, in contact or not.
pub(super) fn leg_limbs(all: &[Limb], stands: bool) -> Vec<usize> {
    let mut found: Vec<usize> = Vec::new();
    for (end, limb) in all.iter().enumerate() {
        let mut at = if limb.stands || !stands {
            Some(end)
        } else {
            None
        };
        while let Some(own) = at {
            at = all[own].parent;
            let is_hip = own != end && at.is_some_and(|parent| all[parent].parent.is_none());
            let is_foot = at.is_some_and(|parent| all[parent].stands);
            if at.is_some() && !is_hip && !is_foot && !found.contains(&own) {
                found.push(own);
            }
        }
    }
    found
}

/// Returns the limbs between the root and the legs: those that end at the root and carry contact points.
pub(super) fn hips(all: &[Limb]) -> Vec<usize> {
    let mut found = Vec::new();
    for end in all.iter().filter(|limb| limb.stands) {
        let mut at = end.parent;
        while let Some(own) = at {
            at = all[own].parent;
            if at == Some(0) && !all[own].stands && !found.contains(&own) {
                found.push(own);
            }
        }
    }
    found
}
