//! Targets of a problem's tasks as geometry: points with positions, frames with orientations.

use crate::problem::ProblemInstance;
use crate::search::SolveError;
use crate::task::{FrameGoal, Quantity};
use kinopt_kinematics::kinematics::FrameSlot;
use kinopt_kinematics::spatial::{Matrix3, Vector3};

/// A target with its weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct WeightedTarget<T> {
    pub(super) target: T,
    /// The squared weight of the residual.
    pub(super) weight: f64,
}

/// The target of one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Goal {
    /// Index in the problem's list of tasks.
    pub(super) task: usize,
    pub(super) frame: FrameSlot,
    /// The point of the frame with a target position, in frame coordinates, metres.
    pub(super) offset: Vector3<f64>,
    pub(super) position: Option<WeightedTarget<Vector3<f64>>>,
    pub(super) orientation: Option<WeightedTarget<Matrix3<f64>>>,
}

/// The kinds of tasks that [`goals`] supports.
const SUPPORTED_TASKS: &str =
    "`point`, `pose` or `orientation`, in the world and without goal bounds";

/// The targets of the problem's tasks, in order. Rows of weight zero have no target.
pub(super) fn goals(
    instance: ProblemInstance<'_>,
    solver: &'static str,
) -> Result<Vec<Goal>, SolveError> {
    let problem = instance.problem;
    if let Some(ball) = problem.parameters().balls().first() {
        return Err(SolveError::BallJoint {
            solver,
            joint: problem.names().variables[ball.variable].clone(),
        });
    }
    let mut goals = Vec::with_capacity(problem.tasks());
    for (index, task) in problem.compiled_tasks().iter().enumerate() {
        let weight = |quantity: Quantity| {
            let mut blocks = task
                .blocks()
                .filter(|block| block.measure.quantity == quantity);
            blocks.next().map_or(0.0, |block| block.weight)
        };
        let residual = instance.residual(index).as_any();
        let Some(frame_goal) =
            FrameGoal::of_residual(residual).filter(|frame_goal| frame_goal.is_complete)
        else {
            return Err(SolveError::UnsupportedTask {
                solver,
                task: task.name().to_owned(),
                valid: SUPPORTED_TASKS,
            });
        };
        let position = (frame_goal.position)
            .and_then(|target| weighted_target(target, weight(Quantity::Metres)));
        let orientation = (frame_goal.orientation)
            .and_then(|target| weighted_target(target, weight(Quantity::Radians)));
        if position.is_some() || orientation.is_some() {
            // All three kinds read exactly one frame.
            goals.extend(task.frames.first().map(|&frame| Goal {
                task: index,
                frame,
                offset: frame_goal.offset,
                position,
                orientation,
            }));
        }
    }
    Ok(goals)
}

fn weighted_target<T>(target: T, weight: f64) -> Option<WeightedTarget<T>> {
    (weight > 0.0).then_some(WeightedTarget {
        target,
        weight: weight * weight,
    })
}
