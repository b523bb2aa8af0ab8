//! Arguments that the solving subcommands share.

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use kinopt::arm::Search;
use kinopt::spatial::Placement;

use crate::failure::Outcome;
use crate::help_headings::{MODEL, OUTPUT, SEARCH, TARGETS};
use crate::model_options::ModelOptions;
use crate::problem::body::Lock;
use crate::problem::interval::Interval;
use crate::problem::number_list::{self, Numbers};
use crate::problem::start::{self, Start};
use crate::problem::target::parse_placement;
use crate::problem::{Problem, SolveSettings};

/// Note on the files of `--problem`, at the end of a help page.
const PROBLEM_NOTE: &str = "\
Further options are keys of the --problem file, such as
  {\"model\": {\"srdf\": \"robot.srdf\"}, \"solve\": {\"attempts\": 50, \"rng_seed\": 1}}
All keys: docs/reference/problem.md. An unknown key is an error that lists the valid ones.";

/// End of a help page: examples, and the note on problem files.
pub(crate) fn with_problem_note(examples: &str) -> String {
    format!("{examples}\n\n{PROBLEM_NOTE}")
}

/// Arguments of every solving subcommand.
#[derive(Args, Debug)]
pub(super) struct QueryArguments {
    /// Robot .urdf or MJCF .xml, rig .json, scene .glb or .gltf, or motion capture .bvh.
    #[arg(value_name = "MODEL")]
    pub(super) model: PathBuf,

    /// Frame in which targets are given. Default: the world.
    #[arg(long, value_name = "FRAME", help_heading = TARGETS)]
    base: Option<String>,

    /// Ignore the orientation of targets.
    #[arg(long, help_heading = TARGETS)]
    position_only: bool,

    /// Avoid self-collisions and the obstacles of a .json or MoveIt .yaml file.
    #[arg(long, value_name = "FILE", help_heading = TARGETS)]
    world: Option<PathBuf>,

    /// Required distance in metres; without --world between links. Default: 0.
    #[arg(long, value_name = "M", value_parser = number_list::not_negative, help_heading = TARGETS)]
    margin: Option<f64>,

    /// Start: numbers, default, rest, bent or random. Default: default.
    #[arg(long, value_name = "START", allow_hyphen_values = true, help_heading = SEARCH)]
    start: Option<Start>,

    /// Tolerance in metres and radians. Default: 1e-6; skeletons: 1e-9 of their size.
    #[arg(long, value_name = "T", value_parser = number_list::not_negative, help_heading = SEARCH)]
    tolerance: Option<f64>,

    /// Lock a joint at a value, or at its start value. Repeatable.
    #[arg(long, value_name = "JOINT[=VALUE]", help_heading = MODEL)]
    lock: Vec<Lock>,

    #[command(flatten)]
    model_options: ModelOptions,

    /// Angles in options and text output are degrees. Default: radians.
    #[arg(long, help_heading = OUTPUT)]
    pub(super) degrees: bool,

    /// Exit with code 3 if a target is not reached.
    #[arg(long, help_heading = OUTPUT)]
    pub(super) fail_on_miss: bool,
}

impl QueryArguments {
    /// Problem of the file with these arguments.
    pub(super) fn problem(&self) -> Outcome<Problem> {
        let mut problem = self.model_options.problem()?;
        set(&mut problem.goal.base, self.base.as_ref());
        problem.goal.position_only |= self.position_only;
        set(&mut problem.collisions.world, self.world.as_ref());
        set(&mut problem.collisions.margin, self.margin.as_ref());
        if let Some(start) = &self.start {
            problem.solve.start = start.typed(self.degrees);
        }
        set(&mut problem.solve.tolerance, self.tolerance.as_ref());
        let locks = self.lock.iter().map(|lock| lock.typed(self.degrees));
        set_list(&mut problem.model.lock, locks);
        Ok(problem)
    }
}

/// Arguments of the target of one tip.
#[derive(Args, Debug)]
pub(super) struct TipArguments {
    /// Frame of targets without a name. Default: the robot's only tip.
    #[arg(long, value_name = "FRAME", help_heading = TARGETS)]
    tip: Option<String>,

    /// Goal bounds in m and rad: x=0.01,z=0..0.05,rz=free.
    #[arg(long, value_name = "AXIS=WIDTH,…", value_delimiter = ',', allow_hyphen_values = true,
          help_heading = TARGETS)]
    interval: Vec<Interval>,

    /// Tool placement in the frame of the targets: x,y,z[,qw,qx,qy,qz].
    #[arg(long, value_name = "PLACEMENT", allow_hyphen_values = true, value_parser = parse_placement,
          help_heading = MODEL)]
    tool: Option<Placement<f64>>,
}

impl TipArguments {
    pub(super) fn add_to(&self, problem: &mut Problem, degrees: bool) {
        let goal = &mut problem.goal;
        set(&mut goal.tip, self.tip.as_ref());
        let intervals = self.interval.iter().map(|interval| interval.typed(degrees));
        set_list(&mut goal.interval, intervals);
        set(&mut goal.tool, self.tool.as_ref());
    }
}

/// Nominal posture.
#[derive(Args, Debug)]
pub(super) struct PostureArgument {
    /// Nominal posture of a robot, one number a joint.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, help_heading = SEARCH)]
    posture: Option<Numbers>,
}

impl PostureArgument {
    pub(super) fn add_to(&self, solve: &mut SolveSettings, degrees: bool) {
        set_numbers(&mut solve.posture, self.posture.as_ref(), degrees);
    }
}

/// Largest displacement.
#[derive(Args, Debug)]
pub(super) struct MaxMoveArgument {
    /// Largest displacement from the start, one number or one a joint.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, help_heading = SEARCH)]
    max_move: Option<Numbers>,
}

impl MaxMoveArgument {
    pub(super) fn add_to(&self, solve: &mut SolveSettings, degrees: bool) {
        set_numbers(&mut solve.max_move, self.max_move.as_ref(), degrees);
    }
}

/// Choice among solutions.
#[derive(Args, Debug)]
pub(super) struct SearchArgument {
    /// Solution: start, first, nearest or distinct:K. Default: start.
    #[arg(long, value_name = "CHOICE", value_parser = start::search, help_heading = SEARCH)]
    search: Option<Search>,
}

impl SearchArgument {
    pub(super) fn add_to(&self, solve: &mut SolveSettings) {
        set(&mut solve.search, self.search.as_ref());
    }
}

/// Held frames and the time limit of a search.
#[derive(Args, Debug)]
pub(super) struct SearchLimits {
    /// Link or bone that keeps its pose, or none. Repeatable.
    #[arg(long, value_name = "NAME", help_heading = MODEL)]
    hold: Vec<String>,

    /// Time limit of a target in ms; results then depend on the machine.
    #[arg(long, value_name = "MS", value_parser = number_list::milliseconds, help_heading = SEARCH)]
    time_limit: Option<Duration>,
}

impl SearchLimits {
    pub(super) fn add_to(&self, problem: &mut Problem) {
        set_list(&mut problem.body.hold, self.hold.iter().cloned());
        set(&mut problem.solve.time_limit, self.time_limit.as_ref());
    }
}

/// Replaces a value by a given one.
pub(crate) fn set<T: Clone>(value: &mut Option<T>, given: Option<&T>) {
    if given.is_some() {
        *value = given.cloned();
    }
}

/// Replaces a list by a given one that is not empty.
pub(crate) fn set_list<T>(list: &mut Vec<T>, given: impl ExactSizeIterator<Item = T>) {
    if given.len() > 0 {
        *list = given.collect();
    }
}

/// Replaces numbers of joints by given ones, with their unit of angles.
pub(crate) fn set_numbers(numbers: &mut Option<Numbers>, given: Option<&Numbers>, degrees: bool) {
    set(numbers, given.map(|given| given.typed(degrees)).as_ref());
}
