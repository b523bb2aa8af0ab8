//! Arguments that the solving subcommands share.

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use kinopt::spatial::Placement;
use kinopt_bindings::problem_file::ProblemSettings;
use kinopt_bindings::problem_file::body::Lock;
use kinopt_bindings::problem_file::interval::Interval;
use kinopt_bindings::problem_file::number_list::{self, Numbers};
use kinopt_bindings::problem_file::start::{self, SolutionChoice, Start};
use kinopt_bindings::problem_file::target::{FrameTarget, parse_placement};

use crate::collision_options::ObstacleOptions;
use crate::failure::Outcome;
use crate::help_headings::{LIMITS, MODEL, OUTPUT, SEARCH, TARGETS};
use crate::model_options::ModelOptions;
use crate::problem_options::{ProblemOptions, set, set_list};

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
pub(crate) struct QueryArguments {
    /// Robot .urdf or MJCF .xml, rig .json, scene .glb, .gltf or .vrm, or capture .bvh.
    #[arg(value_name = "MODEL")]
    pub(crate) model: PathBuf,

    /// Frame in which targets are given. Default: the world.
    #[arg(long, value_name = "FRAME", help_heading = TARGETS)]
    base: Option<String>,

    /// Ignore the orientation of targets.
    #[arg(long, help_heading = TARGETS)]
    position_only: bool,

    #[command(flatten)]
    obstacles: ObstacleOptions,

    /// Tolerance in m and rad. Default: 1e-6; skeletons: 1e-9 of their size.
    #[arg(long, value_name = "T", value_parser = number_list::not_negative, help_heading = SEARCH)]
    tolerance: Option<f64>,

    /// Lock a joint at a value, or at its start value. Repeatable.
    #[arg(long, value_name = "JOINT[=VALUE]", help_heading = MODEL)]
    lock: Vec<Lock>,

    #[command(flatten)]
    model_options: ModelOptions,

    /// Angles in options and text output are degrees. Default: radians.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) degrees: bool,

    /// Exit with code 3 if a target is not reached.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) fail_on_miss: bool,
}

impl QueryArguments {
    /// Problem of the file with these arguments and further groups of options.
    pub(crate) fn problem(&self, options: &[&dyn ProblemOptions]) -> Outcome<ProblemSettings> {
        let mut problem = self.model_options.problem()?;
        set(&mut problem.goal.base, self.base.as_ref());
        problem.goal.position_only |= self.position_only;
        self.obstacles.add_to(&mut problem.collisions);
        set(&mut problem.solve.tolerance, self.tolerance.as_ref());
        let locks = self.lock.iter().map(|lock| lock.typed(self.degrees));
        set_list(&mut problem.model.lock, locks);
        for options in options {
            options.add_to(&mut problem, self.degrees);
        }
        Ok(problem)
    }
}

/// Start configuration.
#[derive(Args, Debug)]
pub(super) struct StartArgument {
    /// Start: numbers, default, rest, bent or random. Default: default.
    #[arg(long, value_name = "START", allow_hyphen_values = true, help_heading = SEARCH)]
    start: Option<Start>,
}

impl ProblemOptions for StartArgument {
    fn add_to(&self, problem: &mut ProblemSettings, degrees: bool) {
        if let Some(start) = &self.start {
            problem.solve.start = start.typed(degrees);
        }
    }
}

/// Targets of frames.
#[derive(Args, Debug)]
pub(super) struct TargetArguments {
    /// Target [FRAME=]x,y,z[,qw,qx,qy,qz], in metres. Repeatable.
    #[arg(long, value_name = "TARGET", allow_hyphen_values = true, help_heading = TARGETS)]
    target: Vec<FrameTarget>,
}

impl ProblemOptions for TargetArguments {
    fn add_to(&self, problem: &mut ProblemSettings, _degrees: bool) {
        set_list(&mut problem.goal.target, self.target.iter().cloned());
    }
}

/// Tip and its goal.
#[derive(Args, Debug)]
pub(crate) struct TipArguments {
    /// Frame of the targets. Default: the robot's only tip.
    #[arg(long, value_name = "FRAME", help_heading = TARGETS)]
    tip: Option<String>,

    /// Goal bounds in m and rad: x=0.01,z=0..0.05,rz=free.
    #[arg(long, value_name = "AXIS=WIDTH,…", value_delimiter = ',', allow_hyphen_values = true,
          help_heading = TARGETS)]
    interval: Vec<Interval>,

    /// Tool placement in the tip: x,y,z[,qw,qx,qy,qz].
    #[arg(long, value_name = "PLACEMENT", allow_hyphen_values = true, value_parser = parse_placement,
          help_heading = MODEL)]
    tool: Option<Placement<f64>>,
}

impl ProblemOptions for TipArguments {
    fn add_to(&self, problem: &mut ProblemSettings, degrees: bool) {
        let goal = &mut problem.goal;
        set(&mut goal.tip, self.tip.as_ref());
        let intervals = self.interval.iter().map(|interval| interval.typed(degrees));
        set_list(&mut goal.interval, intervals);
        set(&mut goal.tool, self.tool.as_ref());
    }
}

/// Choice among solutions.
#[derive(Args, Debug)]
pub(super) struct SearchArgument {
    /// Solution: start, first, nearest or all. Default: start.
    #[arg(long, value_name = "CHOICE", value_parser = start::search, help_heading = SEARCH)]
    search: Option<SolutionChoice>,
}

impl ProblemOptions for SearchArgument {
    fn add_to(&self, problem: &mut ProblemSettings, _degrees: bool) {
        set(&mut problem.solve.search, self.search.as_ref());
    }
}

/// Nominal posture.
#[derive(Args, Debug)]
pub(super) struct PostureArgument {
    /// Nominal posture of a robot, one number a joint.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, help_heading = SEARCH)]
    posture: Option<Numbers>,
}

impl ProblemOptions for PostureArgument {
    fn add_to(&self, problem: &mut ProblemSettings, degrees: bool) {
        let posture = self.posture.as_ref().map(|posture| posture.typed(degrees));
        set(&mut problem.solve.posture, posture.as_ref());
    }
}

/// Largest displacement.
#[derive(Args, Debug)]
pub(super) struct MaxMoveArgument {
    /// Largest displacement from the start, one number or one a joint.
    #[arg(long, value_name = "NUMBERS", allow_hyphen_values = true, help_heading = SEARCH)]
    max_move: Option<Numbers>,
}

impl ProblemOptions for MaxMoveArgument {
    fn add_to(&self, problem: &mut ProblemSettings, degrees: bool) {
        let max_move = self.max_move.as_ref().map(|moves| moves.typed(degrees));
        set(&mut problem.solve.max_move, max_move.as_ref());
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

impl ProblemOptions for SearchLimits {
    fn add_to(&self, problem: &mut ProblemSettings, _degrees: bool) {
        set_list(&mut problem.body.hold, self.hold.iter().cloned());
        set(&mut problem.solve.time_limit, self.time_limit.as_ref());
    }
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
    pub(super) fn typed(&self, degrees: bool) -> Self {
        let typed = |limits: &Option<Numbers>| limits.as_ref().map(|limits| limits.typed(degrees));
        Self {
            velocity_limits: typed(&self.velocity_limits),
            acceleration_limits: typed(&self.acceleration_limits),
            jerk_limits: typed(&self.jerk_limits),
            ..self.clone()
        }
    }
}
