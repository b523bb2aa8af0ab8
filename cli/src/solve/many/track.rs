//! `kinopt track`: a sequence of targets, each from the solution of the one before.

use std::path::PathBuf;

use clap::Args;

use crate::failure::Outcome;
use crate::help_headings::TARGETS;
use crate::solve::arguments::{
    MaxMoveArgument, PostureArgument, QueryArguments, SearchLimits, StartArgument, TipArguments,
    with_problem_note,
};
use crate::solve::job::{Job, Mode};

const EXAMPLES: &str = "\
Examples:
  kinopt track robot.urdf --tip tool --targets line.json
  kinopt track robot.urdf --tip tool --targets line.json --max-move 0.1 --json

The file: {\"targets\": [[x, y, z, qw, qx, qy, qz], …], \"starts\": [[…]], \"tip_link\": \"tool\"}.
The report lists steps in which a joint moves more than 0.2 rad. For a path that is known in
advance, kinopt path has fewer reconfigurations. Guide: docs/guide/followers.md.";

/// Inverse kinematics of a sequence of targets, each from the solution before.
#[derive(Args, Debug)]
#[command(after_help = with_problem_note(EXAMPLES))]
pub(crate) struct Arguments {
    #[command(flatten)]
    query: QueryArguments,

    #[command(flatten)]
    start: StartArgument,

    /// JSON file of targets, in order.
    #[arg(long, value_name = "FILE", help_heading = TARGETS)]
    targets: PathBuf,

    #[command(flatten)]
    tip: TipArguments,

    #[command(flatten)]
    posture: PostureArgument,

    #[command(flatten)]
    max_move: MaxMoveArgument,

    #[command(flatten)]
    limits: SearchLimits,
}

pub(crate) fn run(arguments: &Arguments, json: bool) -> Outcome<()> {
    let problem = arguments.query.problem(&[
        &arguments.start,
        &arguments.tip,
        &arguments.posture,
        &arguments.max_move,
        &arguments.limits,
    ])?;
    let mode = Mode::Track(&arguments.targets);
    Job::new(&arguments.query, &problem, mode).run(json)
}
