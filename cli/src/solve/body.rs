//! `kinopt body`: whole-body inverse kinematics with several tasks.

use clap::Args;
use kinopt_bindings::problem_file::ProblemSettings;
use kinopt_bindings::problem_file::body::{Centre, Foot, FrameWeight, NamedLevel};
use kinopt_bindings::problem_file::number_list::not_negative;
use kinopt_bindings::problem_file::target::RayTarget;

use super::arguments::{
    QueryArguments, SearchLimits, StartArgument, TargetArguments, with_problem_note,
};
use super::job::{Job, Mode};
use super::out_file::OutputFiles;
use crate::failure::Outcome;
use crate::help_headings::{BALANCE, TARGETS};
use crate::problem_options::{ProblemOptions, set, set_list};

const EXAMPLES: &str = "\
Examples:
  kinopt body humanoid.urdf --base-joint free --hold left_foot --hold right_foot --start bent \\
    --balance left_foot --balance right_foot --target left_hand=0.5,0.2,0.9
  kinopt body humanoid.json --ray left_hand=0,-4,1.5:0.5,0,1.2

Held frames come first, then balance, then targets, unless --level sets other levels. More tasks,
such as gaze and posture, are \"tasks\" of the --problem file. Guide: docs/guide/whole-bodies.md.";

/// Whole-body inverse kinematics: several tasks with priorities, balance and held frames.
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
    tasks: BodyTasks,

    #[command(flatten)]
    limits: SearchLimits,

    #[command(flatten)]
    files: OutputFiles,
}

/// Rays, centre of mass, weights and levels.
#[derive(Args, Debug)]
struct BodyTasks {
    /// Line FRAME=ex,ey,ez:mx,my,mz from an eye through a point. Repeatable.
    #[arg(long, value_name = "RAY", help_heading = TARGETS)]
    ray: Vec<RayTarget>,

    /// Target x,y[,z] of the centre of mass; `free` for a free coordinate.
    #[arg(long, value_name = "CENTRE", allow_hyphen_values = true, help_heading = BALANCE)]
    center_of_mass: Option<Centre>,

    /// Centre of mass above a foot, or above a point of it. Repeatable.
    #[arg(long, value_name = "FRAME[=x,y,z]", help_heading = BALANCE)]
    balance: Vec<Foot>,

    /// Distance from the edges of the support polygon, in metres. Default: 0.
    #[arg(long, value_name = "M", value_parser = not_negative, help_heading = BALANCE)]
    balance_margin: Option<f64>,

    /// Factor of a frame's errors, above 0. Default: 1.
    #[arg(long, value_name = "FRAME=W", help_heading = TARGETS)]
    weight: Vec<FrameWeight>,

    /// Priority level of a target, frame or task, from 0 (first).
    #[arg(long, value_name = "NAME=N", help_heading = TARGETS)]
    level: Vec<NamedLevel>,
}

impl ProblemOptions for BodyTasks {
    fn add_to(&self, problem: &mut ProblemSettings, _degrees: bool) {
        set_list(&mut problem.goal.ray, self.ray.iter().cloned());
        let body = &mut problem.body;
        set(&mut body.center_of_mass, self.center_of_mass.as_ref());
        set_list(&mut body.balance, self.balance.iter().cloned());
        set(&mut body.balance_margin, self.balance_margin.as_ref());
        set_list(&mut body.weight, self.weight.iter().cloned());
        set_list(&mut body.level, self.level.iter().cloned());
    }
}

pub(crate) fn run(arguments: &Arguments, json: bool) -> Outcome<()> {
    let problem = arguments.query.problem(&[
        &arguments.start,
        &arguments.target,
        &arguments.tasks,
        &arguments.limits,
    ])?;
    let mode = Mode::One(&arguments.files);
    Job::new(&arguments.query, &problem, mode).run(json)
}
