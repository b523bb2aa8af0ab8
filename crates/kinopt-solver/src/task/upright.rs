//! Posture weights that keep a body upright.

use kinopt_kinematics::model::{JointId, Model};

/// Smallest length of a limb, as a fraction of the longest chain: includes an arm or a leg, not a finger.
const MIN_LIMB_LENGTH: f64 = 0.2;
/// Smallest number of moving joints in a row of a limb; excludes the mount of a camera.
const MIN_LIMB_JOINTS: usize = 2;
/// Weight of joints that carry several limbs, relative to limb joints.
const TRUNK_WEIGHT: f64 = 5.0;

/// Posture weights of some joints of a model.
///
/// Joints that carry several limbs (a spine, the rotation of a free base) get [`TRUNK_WEIGHT`]. The translation of a
/// free base gets 0, because the limbs determine it. All others get 1.
pub(super) fn upright_weights(model: &Model, joints: &[JointId]) -> Vec<f64> {
    let carrier_flags = carries_limbs(model);
    let is_base_translation = |id: JointId| {
        let first_joint = model
            .free_joints()
            .iter()
            .map(|first_joint| first_joint.index());
        first_joint
            .into_iter()
            .any(|first_joint| (first_joint..first_joint + 3).contains(&id.index()))
    };
    let weight = |id: &JointId| match () {
        () if is_base_translation(*id) => 0.0,
        () if carrier_flags.get(id.index()) == Some(&true) => TRUNK_WEIGHT,
        () => 1.0,
    };
    joints.iter().map(weight).collect()
}

/// By joint: true if several limbs branch off at it or below it.
fn carries_limbs(model: &Model) -> Vec<bool> {
    let joints = model.joints();
    let parent = |joint: usize| joints[joint].parent.map(JointId::index);
    let offset = |joint: usize| joints[joint].parent_from_joint.translation.norm();
    // Longest chain from each joint to a frame, metres.
    let mut chain_lengths = vec![0.0_f64; joints.len()];
    for frame in model.frames() {
        if let Some(joint) = frame.joint {
            let length = &mut chain_lengths[joint.index()];
            *length = length.max(frame.joint_from_frame.translation.norm());
        }
    }
    let mut moving = vec![0; joints.len()];
    for joint in (0..joints.len()).rev() {
        moving[joint] += usize::from(joints[joint].moves());
        if let Some(parent) = parent(joint) {
            moving[parent] = moving[parent].max(moving[joint]);
            chain_lengths[parent] = chain_lengths[parent].max(offset(joint) + chain_lengths[joint]);
        }
    }
    let roots = (0..joints.len()).filter(|&joint| parent(joint).is_none());
    let min_length = MIN_LIMB_LENGTH * roots.map(|root| chain_lengths[root]).fold(0.0, f64::max);
    let mut limbs = vec![0; joints.len()];
    let mut carries_limbs = vec![false; joints.len()];
    for joint in (0..joints.len()).rev() {
        carries_limbs[joint] |= limbs[joint] > 1;
        if let Some(parent) = parent(joint) {
            let is_limb = moving[joint] >= MIN_LIMB_JOINTS
                && offset(joint) + chain_lengths[joint] >= min_length;
            limbs[parent] += usize::from(is_limb);
            carries_limbs[parent] |= carries_limbs[joint];
        }
    }
    carries_limbs
}
