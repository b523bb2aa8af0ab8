//! Priority levels of tasks.

use kinopt::model::UnknownName;
use kinopt_bindings::problem_file::BodySettings;
use kinopt_bindings::problem_file::body::NamedLevel;

use super::task_name::{DefaultLevel, TaskName};
use crate::failure::Outcome;

/// Level of held frames, if frames are held or balanced by name.
pub(super) const HELD: usize = 0;
/// Level of the centre of mass in that case.
pub(super) const BALANCE: usize = 1;

/// Level of each task: as typed, else as in `defaults` if frames are held or balanced (`uses_priorities`).
///
/// # Errors
/// A name of no task.
pub(super) fn levels(
    body: &BodySettings,
    tasks: &[TaskName],
    defaults: &[DefaultLevel],
    uses_priorities: bool,
) -> Outcome<Vec<usize>> {
    let uses_priorities = uses_priorities && !body.no_priorities;
    let mut levels: Vec<usize> = defaults
        .iter()
        .map(|default| match *default {
            DefaultLevel::Given(level) => level,
            DefaultLevel::IfPrioritised(level) if uses_priorities => level,
            DefaultLevel::IfPrioritised(_) => 0,
        })
        .collect();
    for NamedLevel { name, level } in &body.level {
        let mut is_known = false;
        for (task, task_level) in tasks.iter().zip(&mut levels) {
            if task.frame == *name {
                (*task_level, is_known) = (*level, true);
            }
        }
        if !is_known {
            let names = tasks.iter().map(|task| task.frame.as_str());
            return Err(UnknownName::new("target, held frame or task", name, names).into());
        }
    }
    Ok(levels)
}
