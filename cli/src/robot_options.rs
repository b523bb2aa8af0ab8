//! How a robot's file is taken.

use std::path::Path;

use clap::Args;
use kinopt::robot::Robot;

use crate::base_joint::BaseJointOptions;
use crate::failure::Outcome;
use crate::help_headings::MODEL;
use crate::output;

/// Options of every subcommand that takes a robot.
#[derive(Args, Debug, Default)]
pub(crate) struct RobotOptions {
    /// Mend a robot's damaged file where that needs no guess. Default: refuse it.
    ///
    /// Limits out of order are exchanged, a joint without <limit> is held at 0, of an element given
    /// twice the first counts, and so on. Each repair is told on standard error; `kinopt info --json`
    /// lists them under "repairs".
    #[arg(long, help_heading = MODEL, hide_short_help = true)]
    lenient: bool,

    /// Keep a robot's joints also within the soft limits of its file (<safety_controller>). Default:
    /// only within <limit>.
    #[arg(long, help_heading = MODEL, hide_short_help = true)]
    soft_limits: bool,

    #[command(flatten)]
    base: BaseJointOptions,
}

impl RobotOptions {
    /// Reads a robot, and tells what was taken where the file says nothing or cannot be right.
    pub(crate) fn read(&self, path: &Path) -> Outcome<Robot> {
        let reader = match self.lenient {
            true => Robot::reader().lenient(),
            false => Robot::reader(),
        };
        let robot = reader.read(path).map_err(|error| {
            let hint = match reader.lenient().read(path) {
                Ok(_) if !self.lenient => " (--lenient mends it)",
                _ => "",
            };
            failure!("{error}{hint}")
        })?;
        let file = path.display();
        for repair in robot.repairs() {
            output::message(&format!("note: {file}:{repair}"));
        }
        let robot = match self.soft_limits {
            true => robot
                .with_soft_limits()
                .map_err(|error| failure!("{file}: soft limits: {error}"))?,
            false => robot,
        };
        self.base.put_under(robot, &file.to_string())
    }

    /// Refuses what only robots have.
    pub(crate) fn refuse(&self, file: &str) -> Outcome<()> {
        let given = [
            (self.lenient, "--lenient"),
            (self.soft_limits, "--soft-limits"),
        ];
        let given = given.into_iter().find(|(given, _)| *given);
        match given.map(|(_, option)| option).or(self.base.given()) {
            Some(option) => Err(usage!("{file}: {option} is for robots (.urdf, .xml)")),
            None => Ok(()),
        }
    }
}
