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

/// Options of every subcommand that reads a model.
#[derive(Args, Debug, Default)]
pub(crate) struct ModelOptions {
    /// Repair damaged robot and SRDF files where no guess is needed, with notes. Default: error.
    #[arg(long, help_heading = MODEL, hide_short_help = true)]
    lenient: bool,

    /// Apply the soft limits of a robot's file (<safety_controller>) too. Default: <limit> alone.
    #[arg(long, help_heading = MODEL, hide_short_help = true)]
    soft_limits: bool,

    /// Limits of a source joint: its own, or also its mimic joints'. Default: source.
    #[arg(long, value_name = "LIMITS", value_parser = ["source", "both"], help_heading = MODEL, hide_short_help = true)]
    mimic_limits: Option<String>,

    /// Joint limits of a robot, as in MoveIt's joint_limits.yaml. Default: the robot's file.
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
    /// Reads a robot. Repairs and defaults of the reader go to standard error.
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
                Ok(_) if !self.lenient => " (--lenient repairs it)",
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

    /// True if an option sets the base joint.
    pub(crate) fn has_base_option(&self) -> bool {
        self.base.given().is_some()
    }

    /// Reads the SRDF file of a robot. Repairs of the reader go to standard error.
    pub(crate) fn read_srdf(&self, path: &Path, robot: &Robot) -> Outcome<Srdf> {
        let reader = match self.lenient {
            true => Srdf::reader().lenient(),
            false => Srdf::reader(),
        };
        let srdf = reader.read(path, robot).map_err(|error| {
            let hint = match reader.lenient().read(path, robot) {
                Ok(_) if !self.lenient => " (--lenient omits it)",
                _ => "",
            };
            failure!("{error}{hint}")
        })?;
        for repair in &srdf.repairs {
            output::message(&format!("note: {}:{repair}", path.display()));
        }
        Ok(srdf)
    }

    /// True if an option gives joints to a scene or a capture.
    pub(crate) fn makes_figure(&self) -> bool {
        self.figure.given().is_some()
    }

    /// Skeleton with the joints of the options.
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

    /// Rejects options of skeletons.
    pub(crate) fn refuse_of_figures(&self, file: &str) -> Outcome<()> {
        let refused = |option| usage!("{file}: {option} is for rigs, scenes and motion capture");
        self.figure
            .given()
            .map_or(Ok(()), |option| Err(refused(option)))
    }

    /// Rejects options of robots.
    pub(crate) fn refuse(&self, file: &str) -> Outcome<()> {
        self.refuse_of_robots(file)?;
        let refused = |option| {
            usage!(
                "{file}: {option} is for robots (.urdf, .xml), and for skeletons with --joints ball"
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
