//! Hierarchy of limbs.

use super::limb::DrivenLimb;
use kinopt_kinematics::model::{FrameId, JointId, Model};
use kinopt_kinematics::spatial::Vector3;

/// Returns the joints from a frame up to the root.
pub(super) fn joints_above(model: &Model, frame: FrameId) -> Vec<JointId> {
    let mut next = model.frames()[frame.index()].joint;
    let joints = std::iter::from_fn(|| {
        let joint = next?;
        next = model.joints()[joint.index()].parent;
        Some(joint)
    });
    joints.collect()
}

/// Returns the joint that moves a frame, if there is one.
pub(super) fn moving_joint(model: &Model, frame: FrameId) -> Option<JointId> {
    let mut joints = joints_above(model, frame).into_iter();
    joints.find(|id| model.joints()[id.index()].kind.moves())
}

/// Returns the position of a limb's end in the frame of the joint that moves it.
fn from_moving_joint(model: &Model, limb: &DrivenLimb) -> Vector3<f64> {
    let frame = &model.frames()[limb.frame.index()];
    let mut position = frame.joint_from_frame.apply(limb.offset);
    let joints = joints_above(model, limb.frame).into_iter();
    for joint in joints.map(|id| &model.joints()[id.index()]) {
        if joint.kind.moves() {
            break;
        }
        position = joint.parent_from_joint.apply(position);
    }
    position
}

/// Sorts limbs parents first and sets their parents: the nearest driven frame towards the root, or the root limb.
pub(super) fn order(model: &Model, all: &mut [DrivenLimb]) {
    let moving = |limb: &DrivenLimb| {
        let joints = joints_above(model, limb.frame);
        let moves = |joint: &JointId| model.joints()[joint.index()].kind.moves();
        joints.into_iter().filter(moves).collect::<Vec<_>>()
    };
    // For equal chains the nearer end comes first: a knee before the ankle at the end of the shin.
    let distance = |limb: &DrivenLimb| from_moving_joint(model, limb).norm();
    all.sort_by(|a, b| {
        let lengths = [a, b].map(|limb| moving(limb).len());
        let distances = [a, b].map(distance);
        lengths[0]
            .cmp(&lengths[1])
            .then(distances[0].total_cmp(&distances[1]))
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
pub(super) fn leg_limbs(all: &[DrivenLimb], contacts_only: bool) -> Vec<usize> {
    let mut legs: Vec<usize> = Vec::new();
    for (end, limb) in all.iter().enumerate() {
        let mut next = if limb.makes_contact || !contacts_only {
            Some(end)
        } else {
            None
        };
        while let Some(current) = next {
            next = all[current].parent;
            let is_hip = current != end && next.is_some_and(|parent| all[parent].parent.is_none());
            let is_foot = next.is_some_and(|parent| all[parent].makes_contact);
            if next.is_some() && !is_hip && !is_foot && !legs.contains(&current) {
                legs.push(current);
            }
        }
    }
    legs
}

/// Returns the limbs between the root and the legs: those that end at the root and carry contact points.
pub(super) fn hips(all: &[DrivenLimb]) -> Vec<usize> {
    let mut hip_limbs = Vec::new();
    for end in all.iter().filter(|limb| limb.makes_contact) {
        let mut next = end.parent;
        while let Some(current) = next {
            next = all[current].parent;
            if next == Some(0) && !all[current].makes_contact && !hip_limbs.contains(&current) {
                hip_limbs.push(current);
            }
        }
    }
    hip_limbs
}
