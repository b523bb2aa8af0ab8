//! Options of reading a model's file.

use std::path::{Path, PathBuf};

use clap::Args;
use kinopt::robot::{BaseJoint, Robot, Srdf};
use kinopt_bindings::problem_file::{ModelSettings, ProblemSettings};

use crate::choices::first_given;
use crate::failure::Outcome;
use crate::file_access;
use crate::help_headings::MODEL;
use crate::json_file;
use crate::output;
use crate::problem_options::{ProblemOptions, set};
use crate::robot_base::{on_base, with_loops};

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
    fn add_to(&self, problem: &mut ProblemSettings, _degrees: bool) {
        set(&mut problem.model.joint_limits, self.joint_limits.as_ref());
    }
}

impl ProblemFile {
    /// Problem of the file, or defaults without a file.
    pub(crate) fn read(&self) -> Outcome<ProblemSettings> {
        let problem = self.problem.as_deref().map(read_problem).transpose()?;
        let problem = problem.unwrap_or_default();
        file_access::allow(&problem.files);
        Ok(problem)
    }
}

/// Problem of a JSON file.
fn read_problem(path: &Path) -> Outcome<ProblemSettings> {
    Ok(ProblemSettings::of_value(json_file::read(path)?, path)?)
}

impl ModelOptions {
    /// Problem of the file with these options.
    pub(crate) fn problem(&self) -> Outcome<ProblemSettings> {
        let mut problem = self.file.read()?;
        let model = &mut problem.model;
        model.lenient |= self.lenient;
        set(&mut model.base_joint, self.base_joint.as_ref());
        Ok(problem)
    }
}

/// Reads a robot. Repairs and defaults of the reader go to standard error.
pub(crate) fn read_robot(settings: &ModelSettings, path: &Path) -> Outcome<Robot> {
    let reader = match file_access::confines() {
        true => Robot::reader().confined(),
        false => Robot::reader(),
    };
    let reader = match settings.lenient {
        true => reader.lenient(),
        false => reader,
    };
    let robot = reader.read(path).map_err(|error| {
        let hint = match reader.lenient().read(path) {
            Ok(_) if !settings.lenient => " (--lenient repairs it)",
            _ => "",
        };
        failure!("{error}{hint}")
    })?;
    let file = path.display();
    let robot = match settings.mimic_limits {
        true => robot
            .with_mimic_limits()
            .map_err(|error| failure!("{file}: mimic limits: {error}"))?,
        false => robot,
    };
    for repair in robot.repairs() {
        output::message(&format!("note: {file}:{repair}"));
    }
    let robot = match settings.soft_limits {
        true => robot
            .with_soft_limits()
            .map_err(|error| failure!("{file}: soft limits: {error}"))?,
        false => robot,
    };
    let robot = match &settings.joint_limits {
        Some(limits) => robot.with_joint_limits(limits)?,
        None => robot,
    };
    let file = file.to_string();
    let robot = on_base(settings, robot, &file)?;
    with_loops(settings, robot, &file)
}

/// Reads the SRDF file of a robot. Repairs of the reader go to standard error.
pub(crate) fn read_srdf(settings: &ModelSettings, path: &Path, robot: &Robot) -> Outcome<Srdf> {
    let reader = match settings.lenient {
        true => Srdf::reader().lenient(),
        false => Srdf::reader(),
    };
    let srdf = reader.read(path, robot).map_err(|error| {
        let hint = match reader.lenient().read(path, robot) {
            Ok(_) if !settings.lenient => " (--lenient omits it)",
            _ => "",
        };
        failure!("{error}{hint}")
    })?;
    for repair in &srdf.repairs {
        output::message(&format!("note: {}:{repair}", path.display()));
    }
    Ok(srdf)
}

/// Rejects settings of skeletons.
pub(crate) fn refuse_skeleton_settings(settings: &ModelSettings, file: &str) -> Outcome<()> {
    let given = first_given([
        ("`joints`", settings.joints.is_some()),
        ("`cones`", settings.cones.is_some()),
        ("`hinges`", settings.hinges.is_some()),
        ("`without_scale`", settings.without_scale),
    ]);
    let refused = |setting| usage!("{file}: {setting} is for rigs, scenes and motion capture");
    given.map_or(Ok(()), |setting| Err(refused(setting)))
}

/// Rejects settings of robots.
pub(crate) fn refuse_robot_settings(settings: &ModelSettings, file: &str) -> Outcome<()> {
    refuse_settings_of_robots(settings, file)?;
    match settings.base_joint {
        Some(_) => Err(usage!(
            "{file}: --base-joint is for robots (.urdf, .xml), and for skeletons on ball joints"
        )),
        None => Ok(()),
    }
}

pub(crate) fn refuse_settings_of_robots(settings: &ModelSettings, file: &str) -> Outcome<()> {
    let given = first_given([
        ("--lenient", settings.lenient),
        ("`soft_limits`", settings.soft_limits),
        ("`mimic_limits`", settings.mimic_limits),
        ("--joint-limits", settings.joint_limits.is_some()),
        ("`connect`", !settings.connect.is_empty()),
        ("`weld`", !settings.weld.is_empty()),
        ("`passive`", !settings.passive.is_empty()),
        ("`without_loops`", settings.without_loops),
    ]);
    match given {
        Some(setting) => Err(usage!("{file}: {setting} is for robots (.urdf, .xml)")),
        None => Ok(()),
    }
}
