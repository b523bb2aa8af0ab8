//! Targets and weights of tasks by sample of a trajectory.

use kinopt::motion::trajectory::MotionProblemBuilder;
use kinopt::task::Task;
use kinopt_bindings::task::{BoxedTask, Goal, Target, TaskBuilder, moved};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays;
use crate::error::invalid;
use crate::object::Object;
use crate::problem::CompiledProblem;

/// Adds tasks with their targets and weights by sample.
pub(super) struct ByFrame<'a, 'm, 'py> {
    pub(super) builder: &'a mut MotionProblemBuilder<'m>,
    /// Index of the added task.
    pub(super) task: usize,
    pub(super) targets: Vec<TaskEntry<'py>>,
    pub(super) weights: Vec<TaskEntry<'py>>,
    pub(super) frames: usize,
}

/// Values of one task, one for each sample.
pub(super) struct TaskEntry<'py> {
    task: usize,
    /// Name in messages.
    what: String,
    values: Bound<'py, PyAny>,
}

/// Reads {"task": one value for each sample}.
pub(super) fn of_tasks<'py>(
    options: &Bound<'py, PyDict>,
    name: &str,
    compiled: &CompiledProblem,
) -> PyResult<Vec<TaskEntry<'py>>> {
    let mut entries: Vec<TaskEntry<'py>> = Vec::new();
    for (key, values) in arrays::items(options.get_item(name)?.as_ref(), name)? {
        let task = compiled.task(&key)?;
        let what = format!("{name} of {}", key.str()?);
        if entries.iter().any(|entry| entry.task == task) {
            return Err(invalid(format!("{name} has two for task {task}")));
        }
        entries.push(TaskEntry { task, what, values });
    }
    Ok(entries)
}

impl TaskBuilder<Object> for ByFrame<'_, '_, '_> {
    fn add_task<R>(&mut self, task: Task<R>, residual: R) -> PyResult<BoxedTask<Object>>
    where
        R: Target,
        R::Goal: Goal<Object>,
    {
        let task_number = self.task;
        let index_of =
            |all: &[TaskEntry<'_>]| all.iter().position(|entry| entry.task == task_number);
        let id = self.builder.add(task);
        if let Some(k) = index_of(&self.weights) {
            let TaskEntry { what, values, .. } = &self.weights[k];
            let weights = arrays::vector_of(values, what, self.frames)?;
            self.builder.weights(id, &weights);
        }
        if let Some(k) = index_of(&self.targets) {
            let targets = read(&self.targets[k], &residual, self.frames)?;
            self.builder.follow(id, move |frame, residual: &mut R| {
                if let Some(target) = targets.get(frame) {
                    // Each target was validated when it was read.
                    let _ = residual.aim(target);
                }
            });
        }
        Ok(Box::new(id))
    }
}

/// Reads one target for each sample, and validates it on the residual.
fn read<R>(entry: &TaskEntry<'_>, residual: &R, frames: usize) -> PyResult<Vec<R::Goal>>
where
    R: Target,
    R::Goal: Goal<Object>,
{
    let what = &entry.what;
    let count = entry
        .values
        .len()
        .map_err(|_| invalid(format!("{what} must be one target a frame")))?;
    if count != frames {
        return Err(invalid(format!("{what} are {count} for {frames} frames")));
    }
    let mut targets = Vec::with_capacity(frames);
    for (frame, value) in entry.values.try_iter()?.enumerate() {
        let what = format!("{what}, frame {frame},");
        let target = R::Goal::read(&Object::of(&value?), &what)?;
        moved::<Object, R>(residual, &target, &what, "")?;
        targets.push(target);
    }
    Ok(targets)
}
