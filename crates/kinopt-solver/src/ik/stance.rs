//! Crouched configuration of a standing model.
//!
//! Straight knees are singular: the first-order model cannot shorten the leg.

use crate::problem::{Problem, ProblemError};
use crate::task::{FramePose, Posture};
use kinopt_kinematics::kinematics::ForwardKinematics;
use kinopt_kinematics::model::{FrameId, JointId, Model, ParameterMap};
use kinopt_kinematics::spatial::Vector3;

use super::Solver;

/// Distance by which the base is lowered, as a fraction of its height above the lowest foot.
const LOWERING_FRACTION: f64 = 1.0 / 15.0;

/// Returns the configuration `q` with the free base lowered by a fifteenth of its height along `up`, and its `feet`
/// fixed.
///
/// The other joints stay near `q`. The knees are slightly bent, so that dragging a hand down bends them more. At full
/// extension a leg is singular, and the spine bends instead. Returns `q` if the model has no free base, if `feet` is
/// empty, or if the feet cannot stay fixed.
///
/// # Errors
/// Returns an error if the configuration, frames or parameter map do not belong to `model`.
pub fn crouched_configuration(
    model: &Model,
    parameters: &ParameterMap,
    feet: &[FrameId],
    q: &[f64],
    up: impl Into<Vector3<f64>>,
) -> Result<Vec<f64>, ProblemError> {
    // Ball joint of the first free joint, and the frame attached to it.
    let first = model.free_joints().first();
    let base = first.map(|first| JointId::new(first.index() + 3));
    let is_on_base = |frame: &FrameId| model.frames()[frame.index()].joint == base;
    let root = model
        .frame_ids()
        .find(is_on_base)
        .filter(|_| base.is_some());
    let Some(root) = root.filter(|_| !feet.is_empty()) else {
        return Ok(q.to_vec());
    };
    let frames: Vec<FrameId> = std::iter::once(root).chain(feet.iter().copied()).collect();
    let mut kinematics = ForwardKinematics::of_frames(model, &frames)?;
    let placements = kinematics.place(q)?;
    let (mut base_target, foot_placements) = (placements[0], &placements[1..]);
    let up = up.into();
    let up = up * (1.0 / up.norm());
    let height = |position: Vector3<f64>| position.dot(up);
    let foot_heights = foot_placements.iter().map(|foot| height(foot.translation));
    let min_foot_height = foot_heights.fold(f64::INFINITY, f64::min);
    base_target.translation = base_target.translation
        - up * (LOWERING_FRACTION * (height(base_target.translation) - min_foot_height));
    let mut problem = Problem::builder(model);
    problem.parameters(parameters.clone());
    problem.add(FramePose::new(root, base_target));
    for (&foot, &placement) in feet.iter().zip(foot_placements) {
        problem.add(FramePose::new(foot, placement));
    }
    problem.add(Posture::new(model, q));
    let solution = Solver::default().solve_once(&problem.build()?, q)?;
    Ok(match solution.reached {
        true => solution.q,
        false => q.to_vec(),
    })
}
