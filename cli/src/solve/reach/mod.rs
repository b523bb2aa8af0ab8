//! `kinopt reach`: reachability of targets, and goal sets of several tools.

mod criterion;
pub(super) mod decision;
pub(super) mod options;
mod report;
mod table_file;

use std::path::PathBuf;

use clap::Args;
use kinopt::spatial::Placement;
use kinopt_bindings::problem_file::ProblemSettings;
use kinopt_bindings::problem_file::interval::Interval;
use kinopt_bindings::problem_file::target::{FrameTarget, parse_placement};

use self::options::ReachOptions;
use super::arguments::{QueryArguments, StartArgument, with_problem_note};
use super::job::{Job, Mode};
use crate::failure::Outcome;
use crate::help_headings::{MODEL, TARGETS};
use crate::problem_options::{ProblemOptions, set, set_list};

const EXAMPLES: &str = "\
Examples:
  kinopt reach robot.urdf --tip tool --target 0.4,0.1,0.5,0,1,0,0
  kinopt reach robot.urdf --tip tool --targets grasps.json --world cell.json --out reach.csv
  kinopt reach robot.urdf --tip flange --targets grasps.json --tool 0,0,0.1 --tool 0,0,0.2 \\
    --criterion manipulability

Each target is reached by a configuration, proven unreachable within the joint limits, or undecided.
Reached pairs of tool and target are listed best first. Targets are numbered from 0 in the order of
the file, tools in the order of --tool. --fail-on-miss counts targets that no tool reaches.
The file: {\"targets\": [[x, y, z, qw, qx, qy, qz], …], \"tip_link\": \"tool\"}.
Guide: docs/guide/reachability.md.";

/// Reachability of targets: configurations or proofs, ranked over several tools.
#[derive(Args, Debug)]
#[command(after_help = with_problem_note(EXAMPLES))]
pub(crate) struct Arguments {
    #[command(flatten)]
    query: QueryArguments,

    #[command(flatten)]
    start: StartArgument,

    #[command(flatten)]
    goal: ReachGoal,

    #[command(flatten)]
    options: ReachOptions,
}

/// Targets, tip and tools.
#[derive(Args, Debug)]
struct ReachGoal {
    /// Target [FRAME=]x,y,z[,qw,qx,qy,qz], in metres.
    #[arg(long, value_name = "TARGET", allow_hyphen_values = true, help_heading = TARGETS,
          conflicts_with = "targets")]
    target: Option<FrameTarget>,

    /// JSON file of targets.
    #[arg(long, value_name = "FILE", help_heading = TARGETS)]
    targets: Option<PathBuf>,

    /// Frame of the targets. Default: the robot's only tip.
    #[arg(long, value_name = "FRAME", help_heading = TARGETS)]
    tip: Option<String>,

    /// Goal bounds in m and rad: x=0.01,z=0..0.05,rz=free.
    #[arg(long, value_name = "AXIS=WIDTH,…", value_delimiter = ',', allow_hyphen_values = true,
          help_heading = TARGETS)]
    interval: Vec<Interval>,

    /// Tool placement in the tip: x,y,z[,qw,qx,qy,qz]. Repeatable.
    #[arg(long, value_name = "PLACEMENT", allow_hyphen_values = true, value_parser = parse_placement,
          help_heading = MODEL)]
    tool: Vec<Placement<f64>>,
}

impl ProblemOptions for ReachGoal {
    fn add_to(&self, problem: &mut ProblemSettings, degrees: bool) {
        let goal = &mut problem.goal;
        set_list(&mut goal.target, self.target.iter().cloned());
        set(&mut goal.tip, self.tip.as_ref());
        let intervals = self.interval.iter().map(|interval| interval.typed(degrees));
        set_list(&mut goal.interval, intervals);
        set(&mut goal.tool, self.tool.first());
    }
}

pub(crate) fn run(arguments: &Arguments, json: bool) -> Outcome<()> {
    let Arguments {
        query,
        start,
        goal,
        options,
    } = arguments;
    let problem = query.problem(&[start, goal, options])?;
    let mode = Mode::Reach(goal.targets.as_deref(), options, &goal.tool);
    Job::new(query, &problem, mode).run(json)
}
