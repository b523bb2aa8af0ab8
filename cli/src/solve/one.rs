//! `kinopt solve`: one pose of an arm or any other model.

use clap::Args;

use super::arguments::{
    MaxMoveArgument, PostureArgument, QueryArguments, SearchArgument, SearchLimits, StartArgument,
    TargetArguments, TipArguments, with_problem_note,
};
use super::job::{Job, Mode};
use super::out_file::OutputFiles;
use crate::failure::Outcome;

const EXAMPLES: &str = "\
Examples:
  kinopt solve robot.urdf --tip tool --target 0.4,0.1,0.5,0,1,0,0 --search all
  kinopt solve robot.urdf --target tool=0.4,0.1,0.5,0,1,0,0 --interval z=0..0.05,rz=free
  kinopt solve arm.json --target bone/6=0.2,0.5,0.1 --out posed.obj

A target that is not reached is a result: the closest pose, its errors and the active limits.
Guide: docs/guide/targets.md. Other jobs: kinopt batch, track, servo, body, path.";

/// Inverse kinematics of one pose: joint values that bring frames to targets.
#[derive(Args, Debug)]
#[command(after_help = with_problem_note(EXAMPLES))]
pub(crate) struct Arguments {
    #[command(flatten)]
    query: QueryArguments,

    #[command(flatten)]
    start: StartArgument,

    #[command(flatten)]
    target: TargetArguments,

    #[command(flatten)]
    tip: TipArguments,

    #[command(flatten)]
    search: SearchArgument,

    #[command(flatten)]
    posture: PostureArgument,

    #[command(flatten)]
    max_move: MaxMoveArgument,

    #[command(flatten)]
    limits: SearchLimits,

    #[command(flatten)]
    files: OutputFiles,
}

pub(crate) fn run(arguments: &Arguments, json: bool) -> Outcome<()> {
    let problem = arguments.query.problem(&[
        &arguments.start,
        &arguments.target,
        &arguments.tip,
        &arguments.search,
        &arguments.posture,
        &arguments.max_move,
        &arguments.limits,
    ])?;
    let mode = Mode::One(&arguments.files);
    Job::new(&arguments.query, &problem, mode).run(json)
}
