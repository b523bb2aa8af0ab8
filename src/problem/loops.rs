//! Tasks that close a model's loops.

use super::builder::PendingTask;
use crate::model::{Loop, LoopKind, Model};
use crate::task::{Point, Pose, Residual, Task};

/// One task for each of the model's loops, in their order.
pub(super) fn tasks(model: &Model) -> impl Iterator<Item = PendingTask> {
    model.loops().iter().map(|own| {
        let [frame, base] = own.frames;
        let [tool, target] = own.frame_from_place;
        match own.kind {
            LoopKind::Connect => {
                let place = Point::new(frame, target.translation).at(tool.translation);
                pending(own, place.relative_to(base))
            }
            LoopKind::Weld => {
                let place = Pose::new(frame, target).with_tool(tool);
                pending(own, place.relative_to(base))
            }
        }
    })
}

fn pending(own: &Loop, residual: impl Residual) -> PendingTask {
    let rows = residual.rows();
    let task = Task::new(residual).named(format!("loop `{}`", own.name));
    let held = rows.iter().fold(task, |task, rows| {
        task.tolerance(rows.quantity, Loop::TOLERANCE)
    });
    let mut pending = PendingTask::new(held);
    pending.is_loop = true;
    pending
}
