//! Options of reading a model's file.

use std::path::{Path, PathBuf};

use clap::Args;
use kinopt::robot::{BaseJoint, Robot, Srdf};

use crate::choices::first_given;
use crate::failure::Outcome;
use crate::file_access;
use crate::help_headings::MODEL;
use crate::loaded_model::LoadedModel;
use crate::output;
use crate::problem::{MimicLimits, ModelSettings, Problem, ProblemOptions, set};

/// Options of every subcommand that reads a model.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct ModelOptions {
    /// Joint between the root and the world. Default: fixed.
    #[arg(long, value_name = "KIND", value_parser = BaseJoint::KINDS, hide_possible_values = true,
          help_heading = MODEL)]
    base_joint: Option<String>,

    /// Repair damaged robot and SRDF files, with notes.
    #[arg(long, help_heading = MODEL)]
    lenient: bool,

    #[command(flatten)]
    file: ProblemFile,
}

/// File of further options.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct ProblemFile {
    /// JSON file of further options; see below.
    #[arg(long, value_name = "FILE", help_heading = MODEL)]
    problem: Option<PathBuf>,
}

/// Joint limits of a robot.
#[derive(Args, Debug)]
pub(crate) struct JointLimitsArgument {
    /// Joint limits, as of MoveIt (joint_limits.yaml). Default: the robot's.
    #[arg(long, value_name = "FILE", help_heading = MODEL)]
    joint_limits: Option<PathBuf>,
}

impl ProblemOptions for JointLimitsArgument {
    fn add_to(&self, problem: &mut Problem, _degrees: bool) {
        set(&mut problem.model.joint_limits, self.joint_limits.as_ref());
    }
}

impl ProblemFile {
    /// Problem of the file, or defaults without a file.
    pub(crate) fn read(&self) -> Outcome<Problem> {
        let problem = self.problem.as_deref().map(Problem::read).transpose()?;
        let problem = problem.unwrap_or_default();
        file_access::allow(&problem.files);
        Ok(problem)
    }
}

impl ModelOptions {
    /// Problem of the file with these options.
    pub(crate) fn problem(&self) -> Outcome<Problem> {
        let mut problem = self.file.read()?;
        let model = &mut problem.model;
        model.lenient |= self.lenient;
        set(&mut model.base_joint, self.base_joint.as_ref());
        Ok(problem)
    }
}

impl ModelSettings {
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
        let robot = match self.mimic_limits {
            Some(MimicLimits::Both) => robot
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
        let robot = self.on_base(robot, &file)?;
        self.with_loops(robot, &file)
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

    /// True if a setting gives joints to a scene or a capture.
    pub(crate) fn makes_figure(&self) -> bool {
        self.joints.is_some() || self.cones.is_some()
    }

    /// Skeleton with the joints of the settings.
    pub(crate) fn figure(&self, loaded: LoadedModel) -> Outcome<LoadedModel> {
        match self.are_balls() {
            true => {
                self.refuse_of_robots(&loaded.file)?;
                loaded.on_balls(self)
            }
            false => {
                self.refuse(&loaded.file)?;
                Ok(loaded)
            }
        }
    }

    /// Rejects settings of skeletons.
    pub(crate) fn refuse_of_figures(&self, file: &str) -> Outcome<()> {
        let given = first_given([
            ("`joints`", self.joints.is_some()),
            ("`cones`", self.cones.is_some()),
            ("`without_scale`", self.without_scale),
        ]);
        let refused = |setting| usage!("{file}: {setting} is for rigs, scenes and motion capture");
        given.map_or(Ok(()), |setting| Err(refused(setting)))
    }

    /// Rejects settings of robots.
    pub(crate) fn refuse(&self, file: &str) -> Outcome<()> {
        self.refuse_of_robots(file)?;
        match self.base_joint {
            Some(_) => Err(usage!(
                "{file}: --base-joint is for robots (.urdf, .xml), and for skeletons on ball joints"
            )),
            None => Ok(()),
        }
    }

    fn refuse_of_robots(&self, file: &str) -> Outcome<()> {
        let given = first_given([
            ("--lenient", self.lenient),
            ("`soft_limits`", self.soft_limits),
            ("`mimic_limits`", self.mimic_limits.is_some()),
            ("--joint-limits", self.joint_limits.is_some()),
            ("`connect`", !self.connect.is_empty()),
            ("`weld`", !self.weld.is_empty()),
            ("`passive`", !self.passive.is_empty()),
            ("`without_loops`", self.without_loops),
        ]);
        match given {
            Some(setting) => Err(usage!("{file}: {setting} is for robots (.urdf, .xml)")),
            None => Ok(()),
        }
    }
}
