//! Tasks of a problem file in a problem of the solver.

use kinopt::model::FrameId;
use kinopt::problem::ProblemBuilder;
use kinopt_bindings::OrRaise;
use kinopt_bindings::problem_file::tasks::{TaskStart, Tasks};
use serde_json::Value;

use super::task_name::{DefaultLevel, GOALS, TaskName};
use crate::failure::Outcome;
use crate::frame_name::BareName;
use crate::loaded_model::LoadedModel;

/// Names of the tasks, in their order.
pub(super) fn names(tasks: &Tasks) -> impl Iterator<Item = TaskName> {
    tasks.0.iter().map(|task| TaskName {
        frame: task.name(),
        held: false,
    })
}

/// Level of each task: its own, else that of required tasks, and 0 for soft tasks.
pub(super) fn levels(tasks: &Tasks) -> impl Iterator<Item = DefaultLevel> {
    tasks.0.iter().map(|task| match task.level() {
        Some(level) => DefaultLevel::Given(level),
        None if task.is_goal() => DefaultLevel::IfPrioritised(GOALS),
        None => DefaultLevel::Given(0),
    })
}

/// Frames on which the tasks depend; all frames for a task of joints.
///
/// # Errors
/// An unknown frame.
pub(super) fn frames(tasks: &Tasks, loaded: &LoadedModel) -> Outcome<Vec<FrameId>> {
    let mut frames = Vec::new();
    for task in &tasks.0 {
        if task.frame_names().next().is_none() {
            frames.extend(loaded.model.frame_ids());
        }
        for name in task.frame_names() {
            let frame = loaded.frame(name, BareName::Tip).or_raise::<Value>();
            frames.push(frame.map_err(|error| task.located(error))?);
        }
    }
    Ok(frames)
}

/// Adds the tasks of a search from `start`, each with its priority level.
///
/// # Errors
/// An unknown name, or an argument of another type.
pub(super) fn add(
    tasks: &Tasks,
    builder: &mut ProblemBuilder<'_>,
    (loaded, start): (&LoadedModel, &[f64]),
    levels: impl Iterator<Item = usize>,
) -> Outcome<()> {
    let start = TaskStart {
        model: &loaded.model,
        frame: &|name| loaded.frame(name, BareName::Tip),
        q: start,
        placements: &loaded.all_frames(start),
    };
    for (task, level) in tasks.0.iter().zip(levels) {
        task.add(builder, &start, level)?;
    }
    Ok(())
}
