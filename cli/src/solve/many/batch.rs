//! `kinopt batch`: many independent targets of a file.

use std::path::PathBuf;

use clap::Args;

use crate::failure::Outcome;
use crate::help_headings::TARGETS;
use crate::solve::arguments::{
    BatchOptions, MaxMoveArgument, PostureArgument, QueryArguments, SearchArgument, SearchLimits,
    StartArgument, TipArguments, with_problem_note,
};
use crate::solve::job::{Job, Mode};

const EXAMPLES: &str = "\
Examples:
  kinopt batch robot.urdf --tip tool --targets poses.json --json
  kinopt batch robot.urdf --tip tool --targets poses.json --together --threads 8

The file: {\"targets\": [[x, y, z, qw, qx, qy, qz], …], \"starts\": [[…], …], \"tip_link\": \"tool\"}.
Guide: docs/guide/batches.md.";

/// Inverse kinematics of many independent targets of one frame, from a file.
#[derive(Args, Debug)]
#[command(after_help = with_problem_note(EXAMPLES))]
pub(crate) struct Arguments {
    #[command(flatten)]
    query: QueryArguments,

    #[command(flatten)]
    start: StartArgument,

    /// JSON file of targets.
    #[arg(long, value_name = "FILE", help_heading = TARGETS)]
    targets: PathBuf,

    #[command(flatten)]
    tip: TipArguments,

    #[command(flatten)]
    batch: BatchOptions,

    #[command(flatten)]
    search: SearchArgument,

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
        &arguments.search,
        &arguments.posture,
        &arguments.max_move,
        &arguments.limits,
    ])?;
    let mode = Mode::Batch(&arguments.targets, &arguments.batch);
    Job::new(&arguments.query, &problem, mode).run(json)
}
