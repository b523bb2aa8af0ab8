//! `kinopt servo`: joint commands at a fixed rate, under motion limits.

use std::path::PathBuf;

use clap::Args;

use crate::failure::Outcome;
use crate::help_headings::{LIMITS, TARGETS};
use crate::model_options::JointLimitsArgument;
use crate::problem::number_list::{self, Numbers};
use crate::solve::arguments::{
    PostureArgument, QueryArguments, StartArgument, TipArguments, with_problem_note,
};
use crate::solve::{Job, Mode};

const EXAMPLES: &str = "\
Examples:
  kinopt servo robot.urdf --rate 1000 --tip tool --targets line.json
  kinopt servo robot.urdf --rate 500 --tip tool --targets line.json --velocity-limits 0.5

The file: {\"targets\": [[x, y, z, qw, qx, qy, qz], …], \"starts\": [[…]], \"tip_link\": \"tool\"}.
Guide: docs/guide/servo.md.";

/// Servo of an arm: one target a control cycle, within velocity, acceleration and jerk limits.
#[derive(Args, Debug)]
#[command(after_help = with_problem_note(EXAMPLES))]
pub(crate) struct Arguments {
    #[command(flatten)]
    query: QueryArguments,

    #[command(flatten)]
    start: StartArgument,

    /// JSON file of targets, one a control cycle.
    #[arg(long, value_name = "FILE", help_heading = TARGETS)]
    targets: PathBuf,

    #[command(flatten)]
    tip: TipArguments,

    #[command(flatten)]
    posture: PostureArgument,

    #[command(flatten)]
    servo: ServoOptions,

    #[command(flatten)]
    joint_limits: JointLimitsArgument,
}

/// Rate and motion limits.
#[derive(Args, Clone, Debug)]
pub(crate) struct ServoOptions {
    /// Control rate in hertz.
    #[arg(long, value_name = "HZ", value_parser = number_list::positive, help_heading = TARGETS)]
    pub(crate) rate: f64,

    /// Joint velocities, rad/s or m/s. Default: the robot's.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, help_heading = LIMITS)]
    pub(crate) velocity_limits: Option<Numbers>,

    /// Accelerations, rad/s² or m/s². Default: the robot's.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, help_heading = LIMITS)]
    pub(crate) acceleration_limits: Option<Numbers>,

    /// Jerks, rad/s³ or m/s³. Default: the robot's.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, help_heading = LIMITS)]
    pub(crate) jerk_limits: Option<Numbers>,

    /// Keep the tool on straight lines between targets.
    #[arg(long, help_heading = LIMITS)]
    pub(crate) straight_line: bool,
}

impl ServoOptions {
    /// Options with the unit of angles.
    fn typed(&self, degrees: bool) -> Self {
        let typed = |limits: &Option<Numbers>| limits.as_ref().map(|limits| limits.typed(degrees));
        Self {
            velocity_limits: typed(&self.velocity_limits),
            acceleration_limits: typed(&self.acceleration_limits),
            jerk_limits: typed(&self.jerk_limits),
            ..self.clone()
        }
    }
}

pub(crate) fn run(arguments: &Arguments, json: bool) -> Outcome<()> {
    let problem = arguments.query.problem(&[
        &arguments.start,
        &arguments.tip,
        &arguments.posture,
        &arguments.joint_limits,
    ])?;
    let options = arguments.servo.typed(arguments.query.degrees);
    let mode = Mode::Servo(&arguments.targets, &options);
    Job::new(&arguments.query, &problem, mode).run(json)
}
