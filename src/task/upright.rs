//! Posture weights that keep a body upright.

use crate::model::{JointId, Model};

/// Smallest length of a limb, as a fraction of the longest chain: includes an arm or a leg, not a finger.
const LENGTH_OF_A_LIMB: f64 = 0.2;
/// Smallest number of moving joints in a row of a limb; excludes the mount of a camera.
const JOINTS_OF_A_LIMB: usize = 2;
/// Weight of joints that carry several limbs, relative to limb joints.
const STIFF: f64 = 5.0;

/// Posture weights of some joints of a model.
///
/// Joints that carry several limbs (a spine, the rotation of a free base) get [`STIFF`]. The translation of a free base
/// gets 0, because the limbs determine it. All others get 1.
pub(super) fn upright_weights(model: &Model, joints: &[JointId]) -> Vec<f64> {
    let carries = carries_limbs(model);
    let slides = |id: JointId| {
        let first = model.free_joints().iter().map(|first| first.index());
        first
            .into_iter()
            .any(|first| (first..first + 3).contains(&id.index()))
    };
    let weight = |id: &JointId| match () {
        () if slides(*id) => 0.0,
        () if carries.get(id.index()) == Some(&true) => STIFF,
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
    let mut long = vec![0.0_f64; joints.len()];
    for frame in model.frames() {
        if let Some(joint) = frame.joint {
            let own = &mut long[joint.index()];
            *own = own.max(frame.joint_from_frame.translation.norm());
        }
    }
    let mut moving = vec![0; joints.len()];
    for joint in (0..joints.len()).rev() {
        moving[joint] += usize::from(joints[joint].moves());
        if let Some(parent) = parent(joint) {
            moving[parent] = moving[parent].max(moving[joint]);
            long[parent] = long[parent].max(offset(joint) + long[joint]);
        }
    }
    let roots = (0..joints.len()).filter(|&joint| parent(joint).is_none());
    let least = LENGTH_OF_A_LIMB * roots.map(|root| long[root]).fold(0.0, f64::max);
    let mut limbs = vec![0; joints.len()];
    let mut carries = vec![false; joints.len()];
    for joint in (0..joints.len()).rev() {
        carries[joint] |= limbs[joint] > 1;
        if let Some(parent) = parent(joint) {
            let is_limb = moving[joint] >= JOINTS_OF_A_LIMB && offset(joint) + long[joint] >= least;
            limbs[parent] += usize::from(is_limb);
            carries[parent] |= carries[joint];
        }
    }
    carries
}
