//! Kinematic chains between two frames, and end frames of the tree.

use kinopt_kinematics::model::{FrameId, JointId, Model};

/// The moving joints from `base` up to the common ancestor and down to `tip`.
pub(super) fn between(model: &Model, base: FrameId, tip: FrameId) -> Vec<JointId> {
    let path = model.path(Some(base), tip);
    let joints = path.up.into_iter().chain(path.down);
    joints
        .filter(|&joint| model.coordinate(joint).is_some())
        .collect()
}

/// The frames whose joint has no child joint. All frames of such a joint count, for example a flange and a tool point.
/// Frames in the world count only in a model without joints.
pub(super) fn tips(model: &Model) -> Vec<FrameId> {
    let mut carries = vec![false; model.joints().len()];
    for parent in model.joints().iter().filter_map(|joint| joint.parent) {
        carries[parent.index()] = true;
    }
    let world_is_all = model.joints().is_empty();
    model
        .frame_ids()
        .filter(|frame| match model.frames()[frame.index()].joint {
            Some(joint) => !carries[joint.index()],
            None => world_is_all,
        })
        .collect()
}
