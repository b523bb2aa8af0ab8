//! `--level`: priority levels of tasks.

use clap::Args;
use kinopt::model::UnknownName;

use super::task_name::TaskName;
use crate::failure::Outcome;
use crate::help_headings::TARGETS;

/// Level of held frames, if frames are held or balanced by name.
pub(super) const HELD: usize = 0;
/// Level of the centre of mass in that case.
pub(super) const BALANCE: usize = 1;
/// Level of all other required tasks in that case.
pub(super) const GOALS: usize = 2;

/// Options of priority levels.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct LevelArguments {
    /// Priority level of a target, frame or task, from 0 (first); see docs/guide/priorities.md.
    #[arg(long = "level", value_name = "NAME=N", value_parser = NamedLevel::parse, help_heading = TARGETS,
          hide_short_help = true)]
    levels: Vec<NamedLevel>,

    /// Give all tasks level 0 unless --level names them. Default: held frames, balance, others.
    #[arg(long, help_heading = TARGETS, hide_short_help = true)]
    no_priorities: bool,
}

/// Level of a named task: `NAME=N`.
#[derive(Clone, Debug, PartialEq)]
struct NamedLevel {
    name: String,
    level: usize,
}

impl NamedLevel {
    fn parse(text: &str) -> Result<Self, String> {
        let (name, level) = text.rsplit_once('=').unwrap_or_default();
        match (name.trim(), level.trim().parse()) {
            ("", _) => Err("expected NAME=LEVEL".to_owned()),
            (_, Err(_)) => Err(format!(
                "`{level}` is not a level; expected a whole number from 0"
            )),
            (name, Ok(level)) => Ok(Self {
                name: name.to_owned(),
                level,
            }),
        }
    }
}

impl LevelArguments {
    /// True if an option sets a level.
    pub(super) fn given(&self) -> bool {
        !self.levels.is_empty()
    }

    /// Level of each task: as typed, else as in `defaults` if frames are held or balanced (`uses_priorities`).
    ///
    /// # Errors
    /// A name of no task.
    pub(super) fn of(
        &self,
        tasks: &[TaskName],
        defaults: &[DefaultLevel],
        uses_priorities: bool,
    ) -> Outcome<Vec<usize>> {
        let uses_priorities = uses_priorities && !self.no_priorities;
        let mut levels: Vec<usize> = defaults
            .iter()
            .map(|default| match *default {
                DefaultLevel::Given(level) => level,
                DefaultLevel::IfPrioritised(level) if uses_priorities => level,
                DefaultLevel::IfPrioritised(_) => 0,
            })
            .collect();
        for NamedLevel { name, level } in &self.levels {
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
}

/// Level of a task without --level.
#[derive(Clone, Copy, Debug)]
pub(super) enum DefaultLevel {
    /// Level of the task file.
    Given(usize),
    /// Level if frames are held or balanced by name; otherwise 0.
    IfPrioritised(usize),
}
