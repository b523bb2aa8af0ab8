//! Tasks that close a model's loops.

use super::builder::PendingTask;
use crate::task::{FramePose, Point, Residual, Task};
use kinopt_kinematics::model::{Loop, LoopKind, Model};

/// One task for each of the model's loops, in their order.
pub(super) fn tasks(model: &Model) -> impl Iterator<Item = PendingTask> {
    model.loops().iter().map(|model_loop| {
        let [frame, base] = model_loop.frames;
        let [tool, target] = model_loop.frame_from_place;
        match model_loop.kind {
            LoopKind::Connect => {
                let residual = Point::new(frame, target.translation).at(tool.translation);
                pending(model_loop, residual.relative_to(base))
            }
            LoopKind::Weld => {
                let residual = FramePose::new(frame, target).with_tool(tool);
                pending(model_loop, residual.relative_to(base))
            }
        }
    })
}

fn pending(model_loop: &Loop, residual: impl Residual) -> PendingTask {
    let rows = residual.rows();
    let task = Task::new(residual).named(format!("loop `{}`", model_loop.name));
    let task_with_tolerances = rows.iter().fold(task, |task, rows| {
        task.tolerance(rows.quantity, Loop::TOLERANCE)
    });
    let mut pending = PendingTask::new(task_with_tolerances);
    pending.is_loop = true;
    pending
}
