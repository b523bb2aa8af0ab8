//! Which joints keep a body upright.

use crate::model::{JointId, Model};

/// A limb is at least so long, as a share of the body's longest way: an arm, a leg, not a finger.
const LENGTH_OF_A_LIMB: f64 = 0.2;
/// And has at least so many joints that move, one after the other; a camera's mount has none.
const JOINTS_OF_A_LIMB: usize = 2;
/// How much more what carries limbs keeps to its posture than limbs do.
const STIFF: f64 = 5.0;

/// How much each of some joints of a model keeps to its posture where the body should stay upright: what several
/// limbs hang on (a back, a free base's turn) five times as much as limbs do, a free base's slides not at all, as
/// limbs say where it is.
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

/// By joint: whether several limbs branch off at it or beyond.
fn carries_limbs(model: &Model) -> Vec<bool> {
    let joints = model.joints();
    let parent = |joint: usize| joints[joint].parent.map(JointId::index);
    let offset = |joint: usize| joints[joint].parent_from_joint.translation.norm();
    // How far each joint's part of the body goes on.
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
