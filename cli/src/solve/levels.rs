//! `--level`: priority levels of goals.

use clap::Args;
use kinopt::model::UnknownName;

use super::task_name::TaskName;
use crate::failure::Outcome;
use crate::help_headings::TARGETS;

/// Of what is held, where something is held or balanced by name.
pub(super) const HELD: usize = 0;
/// Of the centre of mass there.
pub(super) const BALANCE: usize = 1;
/// Of all other goals there.
pub(super) const GOALS: usize = 2;

/// Options about strict levels.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct LevelArguments {
    /// On which strict level something that is asked for stands: a whole number.
    ///
    /// Level 0 comes first: it is met as if it were alone. What is on level 1 comes as near as it can at no cost to level
    /// 0, and so on, whatever the weights, which count within a level. Names are those of targets, rays and held
    /// frames, `balance`, `center of mass` and the names of --tasks. Default: 0 for all; with --hold or --balance what
    /// is held has 0, the balance 1, and all other goals have 2, so that feet neither slip nor lose balance
    /// for a hand that is out of reach. Where everything is reached, levels change nothing but rounding.
    #[arg(long = "level", value_name = "NAME=N", value_parser = NamedLevel::parse, help_heading = TARGETS,
          hide_short_help = true)]
    levels: Vec<NamedLevel>,

    /// Weigh all goals against each other, whatever is held: the default of --level is 0 for all.
    ///
    /// Default: off.
    #[arg(long, help_heading = TARGETS, hide_short_help = true)]
    no_priorities: bool,
}

/// `NAME=N`.
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
            (_, Err(_)) => Err(format!("`{level}` is no whole number of at least 0")),
            (name, Ok(level)) => Ok(Self {
                name: name.to_owned(),
                level,
            }),
        }
    }
}

impl LevelArguments {
    /// Whether any is given.
    pub(super) fn given(&self) -> bool {
        !self.levels.is_empty()
    }

    /// The level of each of these tasks: as typed, or else as `ranked` has it where something is held or balanced
    /// (`steps_back`).
    ///
    /// # Errors
    /// A name that none of the tasks has.
    pub(super) fn of(
        &self,
        tasks: &[TaskName],
        ranked: &[Unless],
        steps_back: bool,
    ) -> Outcome<Vec<usize>> {
        let steps_back = steps_back && !self.no_priorities;
        let mut levels: Vec<usize> = ranked
            .iter()
            .map(|own| match *own {
                Unless::Said(level) => level,
                Unless::Ranked(level) if steps_back => level,
                Unless::Ranked(_) => 0,
            })
            .collect();
        for NamedLevel { name, level } in &self.levels {
            let mut found = false;
            for (task, own) in tasks.iter().zip(&mut levels) {
                if task.frame == *name {
                    (*own, found) = (*level, true);
                }
            }
            if !found {
                let names = tasks.iter().map(|task| task.frame.as_str());
                return Err(UnknownName::new("target, held frame or task", name, names).into());
            }
        }
        Ok(levels)
    }
}

/// The level of a task unless --level says another.
#[derive(Clone, Copy, Debug)]
pub(super) enum Unless {
    /// Of its own.
    Said(usize),
    /// Where something is held or balanced by name; else 0.
    Ranked(usize),
}
