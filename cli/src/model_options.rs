//! Options of reading a model's file.

use std::path::{Path, PathBuf};

use clap::Args;
use kinopt::robot::{Robot, Srdf};

use crate::ball_figure::FigureOptions;
use crate::base_joint::BaseJointOptions;
use crate::choices::first_given;
use crate::failure::Outcome;
use crate::file_access;
use crate::help_headings::MODEL;
use crate::loaded_model::LoadedModel;
use crate::loop_options::LoopOptions;
use crate::output;

/// Options of every subcommand that takes a model: of robots, and of figures.
#[derive(Args, Debug, Default)]
pub(crate) struct ModelOptions {
    /// Mend a robot's damaged file where that needs no guess. Default: refuse it.
    ///
    /// Limits out of order are exchanged, a joint without <limit> is held at 0, of an element given
    /// twice the first counts, and so on; of an SRDF file what names what the robot has not is left out.
    /// Each repair is told on standard error; `kinopt info --json` lists the robot's under "repairs".
    #[arg(long, help_heading = MODEL, hide_short_help = true)]
    lenient: bool,

    /// Keep a robot's joints also within the soft limits of its file (<safety_controller>). Default:
    /// only within <limit>.
    #[arg(long, help_heading = MODEL, hide_short_help = true)]
    soft_limits: bool,

    /// Limits that restrict a joint which mimic joints follow: its own (`source`), or also those of its mimic joints (`both`).
    /// Default: source.
    #[arg(long, value_name = "WHICH", value_parser = ["source", "both"], help_heading = MODEL, hide_short_help = true)]
    mimic_limits: Option<String>,

    /// Limits of a robot's joints, as MoveIt's joint_limits.yaml: velocities and accelerations, and positions within those of its own file.
    /// Default: the robot's file alone.
    #[arg(long, value_name = "FILE", help_heading = MODEL, hide_short_help = true)]
    joint_limits: Option<PathBuf>,

    #[command(flatten)]
    base: BaseJointOptions,

    #[command(flatten)]
    loops: LoopOptions,

    #[command(flatten)]
    figure: FigureOptions,
}

impl ModelOptions {
    /// Reads a robot, and tells what was taken where the file says nothing or cannot be right.
    pub(crate) fn read(&self, path: &Path) -> Outcome<Robot> {
        let reader = match file_access::confines() {
            true => Robot::reader().confined(),
            false => Robot::reader(),
        };
        let reader = match self.lenient {
            true => reader.lenient(),
            false => reader,
        };
        let robot = reader.read(path).map_err(|error| {
            let hint = match reader.lenient().read(path) {
                Ok(_) if !self.lenient => " (--lenient mends it)",
                _ => "",
            };
            failure!("{error}{hint}")
        })?;
        let file = path.display();
        let robot = match self.mimic_limits.as_deref() {
            Some("both") => robot
                .with_mimic_limits()
                .map_err(|error| failure!("{file}: mimic limits: {error}"))?,
            _ => robot,
        };
        for repair in robot.repairs() {
            output::message(&format!("note: {file}:{repair}"));
        }
        let robot = match self.soft_limits {
            true => robot
                .with_soft_limits()
                .map_err(|error| failure!("{file}: soft limits: {error}"))?,
            false => robot,
        };
        let robot = match &self.joint_limits {
            Some(limits) => robot.with_joint_limits(limits)?,
            None => robot,
        };
        let file = file.to_string();
        let robot = self.base.put_under(robot, &file)?;
        self.loops.close(robot, &file)
    }

    /// Whether it is said what a robot's root moves on.
    pub(crate) fn says_base(&self) -> bool {
        self.base.given().is_some()
    }

    /// Reads what an SRDF file says of a robot, and tells what was left out.
    pub(crate) fn read_srdf(&self, path: &Path, robot: &Robot) -> Outcome<Srdf> {
        let reader = match self.lenient {
            true => Srdf::reader().lenient(),
            false => Srdf::reader(),
        };
        let srdf = reader.read(path, robot).map_err(|error| {
            let hint = match reader.lenient().read(path, robot) {
                Ok(_) if !self.lenient => " (--lenient leaves it out)",
                _ => "",
            };
            failure!("{error}{hint}")
        })?;
        for repair in &srdf.repairs {
            output::message(&format!("note: {}:{repair}", path.display()));
        }
        Ok(srdf)
    }

    /// Whether a scene or a capture is to be a model with joints.
    pub(crate) fn makes_figure(&self) -> bool {
        self.figure.given().is_some()
    }

    /// A figure as the options say.
    pub(crate) fn figure(&self, loaded: LoadedModel) -> Outcome<LoadedModel> {
        match self.figure.are_balls() {
            true => {
                self.refuse_of_robots(&loaded.file)?;
                let root = self.base.root()?;
                loaded.on_balls(&self.figure, root)
            }
            false => {
                self.refuse(&loaded.file)?;
                Ok(loaded)
            }
        }
    }

    /// Refuses what only figures have.
    pub(crate) fn refuse_of_figures(&self, file: &str) -> Outcome<()> {
        let refused = |option| usage!("{file}: {option} is for rigs, scenes and motion capture");
        self.figure
            .given()
            .map_or(Ok(()), |option| Err(refused(option)))
    }

    /// Refuses what only robots have.
    pub(crate) fn refuse(&self, file: &str) -> Outcome<()> {
        self.refuse_of_robots(file)?;
        let refused = |option| {
            usage!(
                "{file}: {option} is for robots (.urdf, .xml), and for figures with --joints ball"
            )
        };
        self.base
            .given()
            .map_or(Ok(()), |option| Err(refused(option)))
    }

    fn refuse_of_robots(&self, file: &str) -> Outcome<()> {
        let given = first_given([
            ("--lenient", self.lenient),
            ("--soft-limits", self.soft_limits),
            ("--mimic-limits", self.mimic_limits.is_some()),
            ("--joint-limits", self.joint_limits.is_some()),
        ]);
        match given.or(self.loops.given()) {
            Some(option) => Err(usage!("{file}: {option} is for robots (.urdf, .xml)")),
            None => Ok(()),
        }
    }
}
