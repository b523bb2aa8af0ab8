//! `kinopt servo`: joint commands at a fixed rate, under motion limits.

use std::path::PathBuf;

use clap::Args;

use crate::failure::Outcome;
use crate::help_headings::TARGETS;
use crate::model_options::JointLimitsArgument;
use crate::solve::arguments::{
    PostureArgument, QueryArguments, ServoOptions, StartArgument, TipArguments, with_problem_note,
};
use crate::solve::job::{Job, Mode};

const EXAMPLES: &str = "\
Examples:
  kinopt servo robot.urdf --rate 1000 --tip tool --targets line.json
  kinopt servo robot.urdf --rate 500 --tip tool --targets line.json --velocity-limits 0.5

The file: {\"targets\": [[x, y, z, qw, qx, qy, qz], …], \"starts\": [[…]], \"tip_link\": \"tool\"}.
Guide: docs/guide/servo.md.";

/// Servo of an arm: one target a control cycle, within motion limits.
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
