//! Limb lengths of a subject and of a model.

use std::f64::consts::TAU;

use super::limb::DrivenLimb;
use super::limb_tree::joints_above;
use super::{Capture, RetargetError, UpAxis};
use kinopt_kinematics::kinematics::ForwardKinematics;
use kinopt_kinematics::model::{JointId, Model};
use kinopt_kinematics::spatial::{Placement, Vector3};

/// Number of capture frames, and of random configurations of a model, from which lengths are measured.
const SAMPLES: usize = 256;
/// Quantile of the measured lengths that counts as limb length: that of a stretched limb of two bones, without
/// outliers.
const LENGTH_QUANTILE: f64 = 0.9;

/// Returns the positions of the driven points in random configurations of a model.
pub(super) fn model_positions(
    model: &Model,
    all: &[DrivenLimb],
) -> Result<Vec<Vector3<f64>>, RetargetError> {
    let mut kinematics = ForwardKinematics::new(model);
    let mut positions = Vec::with_capacity(SAMPLES * all.len());
    for seed in 0..SAMPLES {
        let q = model.random_configuration(seed as u64);
        let placed = kinematics
            .place(&q)
            .map_err(|error| RetargetError::Map(error.to_string()))?;
        positions.extend(
            all.iter()
                .map(|limb| placed[limb.frame.index()].apply(limb.offset)),
        );
    }
    Ok(positions)
}

/// Returns the positions of the driving joints in capture frames spread over a capture.
pub(super) fn capture_positions(
    capture: &Capture,
    all: &[DrivenLimb],
    up: UpAxis,
) -> Vec<Vector3<f64>> {
    let step = capture.frames().div_ceil(SAMPLES).max(1);
    let frames = (0..capture.frames())
        .step_by(step)
        .filter_map(|frame| capture.frame(frame));
    let positions = frames.flat_map(|joints| all.iter().map(|limb| up.upright(joints[limb.joint])));
    positions.collect()
}

/// Returns the length of each limb; 0 for the root.
pub(super) fn lengths(all: &[DrivenLimb], positions: &[Vector3<f64>]) -> Vec<f64> {
    let limb_length = |(k, limb): (usize, &DrivenLimb)| {
        let Some(parent) = limb.parent else {
            return 0.0;
        };
        let frames = positions.chunks_exact(all.len());
        let mut lengths: Vec<f64> = frames
            .map(|points| (points[k] - points[parent]).norm())
            .collect();
        quantile(&mut lengths, LENGTH_QUANTILE)
    };
    all.iter().enumerate().map(limb_length).collect()
}

/// Returns the length of a limb at rest if one of its joints has no limits, because random configurations would fold
/// it.
pub(super) fn rest_length(
    model: &Model,
    all: &[DrivenLimb],
    limb: &DrivenLimb,
    rest: &[Placement<f64>],
) -> Option<f64> {
    let parent = &all[limb.parent?];
    let above_parent = joints_above(model, parent.frame);
    let mut inside = joints_above(model, limb.frame).into_iter();
    let unlimited = |id: JointId| {
        let joint = &model.joints()[id.index()];
        let range = joint.limits.upper - joint.limits.lower;
        joint.kind.is_ball() || (joint.kind.moves() && !joint.kind.slides() && range >= TAU - 1e-6)
    };
    let folds = inside.any(|id| !above_parent.contains(&id) && unlimited(id));
    let end_position = |limb: &DrivenLimb| rest[limb.frame.index()].apply(limb.offset);
    folds.then(|| (end_position(limb) - end_position(parent)).norm())
}

pub(super) fn quantile(values: &mut [f64], fraction: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let last = values.len().saturating_sub(1);
    let index = (fraction * last as f64) as usize;
    values.get(index).copied().unwrap_or(0.0)
}
