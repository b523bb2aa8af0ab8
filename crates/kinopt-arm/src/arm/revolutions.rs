//! Whole revolutions of joints.

use super::arm::Arm;
use super::workspace::ArmWorkspace;
use crate::simd_ik::nearest_revolution;

/// Adds whole revolutions to joints of the workspace's x that can make them and drive no mimic joint.
pub(super) fn unwrap_towards(arm: &Arm, start: &[f64], workspace: &mut ArmWorkspace) {
    let (model, map) = (&arm.serial.model, &arm.serial.map);
    for (i, value) in workspace.x.iter_mut().enumerate() {
        let joint = &model.joints()[model.moving_joints()[map.leaders()[i]].index()];
        let bounds = (workspace.question.lower[i], workspace.question.upper[i]);
        if !joint.kind.slides() && !arm.serial.drives_mimic[i] {
            *value = nearest_revolution(start[i], *value, bounds);
        }
    }
}
