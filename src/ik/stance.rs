//! A body that stands with its knees straight cannot feel that they bend.

use crate::kinematics::{ForwardKinematics, KinematicsError};
use crate::model::{FrameId, JointId, Model, ParameterMap};
use crate::problem::{Problem, ProblemError};
use crate::search::SolveError;
use crate::spatial::Vector3;
use crate::task::{Pose, Posture};

use super::Solver;

/// How far the base comes down, as a share of its height over its feet.
const DOWN: f64 = 1.0 / 15.0;

/// Why there is no stance.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StanceError {
    /// Frames or numbers that are not the model's.
    #[error(transparent)]
    Kinematics(#[from] KinematicsError),
    /// What cannot be asked.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// What the solver refuses.
    #[error(transparent)]
    Solve(#[from] SolveError),
}

/// The configuration `q` with the free base of a body a fifteenth of its height lower, along `up`, its `feet` where they
/// are, and the rest near `q`: knees are bent a little, so that dragging a hand down bends them more. At full stretch
/// a leg does not feel, to first order, that it could be shorter, and a back bends instead. A body without a free
/// base or without feet, and one whose feet cannot stay, keeps `q`.
///
/// # Errors
/// A configuration or frames that are not of this model, or a map of another one.
pub fn bent_stance(
    model: &Model,
    parameters: &ParameterMap,
    feet: &[FrameId],
    q: &[f64],
    up: impl Into<Vector3<f64>>,
) -> Result<Vec<f64>, StanceError> {
    // The ball of the first free joint, and what stands on it.
    let first = model.free_joints().first();
    let base = first.map(|first| JointId::new(first.index() + 3));
    let carried = |frame: &FrameId| model.frames()[frame.index()].joint == base;
    let root = model.frame_ids().find(carried).filter(|_| base.is_some());
    let Some(root) = root.filter(|_| !feet.is_empty()) else {
        return Ok(q.to_vec());
    };
    let frames: Vec<FrameId> = std::iter::once(root).chain(feet.iter().copied()).collect();
    let mut kinematics = ForwardKinematics::of_frames(model, &frames)?;
    let placed = kinematics.place(q)?;
    let (mut lowered, standing) = (placed[0], &placed[1..]);
    let up = up.into();
    let up = up * (1.0 / up.norm());
    let height = |at: Vector3<f64>| at.dot(up);
    let soles = standing.iter().map(|foot| height(foot.translation));
    let sole = soles.fold(f64::INFINITY, f64::min);
    lowered.translation = lowered.translation - up * (DOWN * (height(lowered.translation) - sole));
    let mut problem = Problem::builder(model);
    problem.parameters(parameters.clone());
    problem.add(Pose::new(root, lowered));
    for (&foot, &at) in feet.iter().zip(standing) {
        problem.add(Pose::new(foot, at));
    }
    problem.add(Posture::new(model, q));
    let solution = Solver::default().solve_once(&problem.build()?, q)?;
    Ok(match solution.reached {
        true => solution.q,
        false => q.to_vec(),
    })
}
