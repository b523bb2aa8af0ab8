//! `kinopt batch`: many independent targets of a file.

use std::path::PathBuf;

use clap::Args;

use crate::failure::Outcome;
use crate::help_headings::{SEARCH, TARGETS};
use crate::solve::arguments::{
    MaxMoveArgument, PostureArgument, QueryArguments, SearchArgument, SearchLimits, StartArgument,
    TipArguments, with_problem_note,
};
use crate::solve::{Job, Mode};

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

/// Order in which targets are solved; results do not depend on it.
#[derive(Args, Debug)]
pub(crate) struct BatchOptions {
    /// Solve all targets in one call, faster; reports only the mean time.
    #[arg(long, help_heading = SEARCH)]
    pub(crate) together: bool,

    /// Number of threads, 1 to 1024. Default: 1.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024),
          help_heading = SEARCH)]
    pub(crate) threads: Option<u16>,
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
