//! Joints that no task feels.

use kinopt::model::{FrameId, Source};

use crate::loaded_model::LoadedModel;

/// The coordinates of a robot that move none of some frames, which every solver leaves where the
/// start has them. None for a rig, whose whole pose is the answer.
pub(super) fn bystanders(loaded: &LoadedModel, frames: &[FrameId]) -> Vec<usize> {
    if loaded.robot.is_none() {
        return Vec::new();
    }
    let (model, map) = (&loaded.model, loaded.own_parameters());
    let variable = |coordinate: usize| match map.sources().get(coordinate) {
        Some(Source::Variable { variable, .. }) => Some(*variable),
        _ => None,
    };
    let mut felt = vec![false; map.variables()];
    for frame in frames {
        let mut at = model.frames().get(frame.index()).and_then(|f| f.joint);
        while let Some(id) = at {
            let variable = model.coordinate(id).and_then(variable);
            if let Some(felt) = variable.and_then(|variable| felt.get_mut(variable)) {
                *felt = true;
            }
            at = model.joints().get(id.index()).and_then(|j| j.parent);
        }
    }
    let unfelt = |&coordinate: &usize| {
        variable(coordinate).is_some_and(|v| !felt.get(v).copied().unwrap_or(true))
    };
    (0..model.degrees_of_freedom()).filter(unfelt).collect()
}
