//! Arguments of `kinopt bench`.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, ValueEnum};
use kinopt_harness::{Budget, contenders};

use crate::model_options::ModelOptions;
use crate::number_list;

const EXAMPLES: &str = "\
Examples:
  kinopt bench robot.urdf --problems random:100 --out results
        every solver by every derivative route, on 100 random reachable poses
  kinopt bench robot.urdf --targets poses.json --out results
        on targets of your own
  kinopt bench man.json --solver 'kinopt default' --solver 'argmin L-BFGS' --out results
        two solvers on the pinned tips of a rig

Interrupt it (Ctrl-C) when you have seen enough: what is done is written.";

/// Compare all solvers by all derivative routes on the same problems.
///
/// Writes results.json, results.md and pictures (SVG) into a folder: a performance profile, the
/// solved fraction over time, the derivative routes, the cost over the steps of one problem, and the
/// cost of one Jacobian against the number of bones. Answers are judged by forward kinematics and
/// the joint limits. The same seed makes the same answers, as long as no time limit ends a search.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The model: a robot's .urdf or MJCF .xml or a rig's .json file.
    #[arg(value_name = "MODEL")]
    pub(super) model: PathBuf,

    /// Where to write; made if it is not there.
    #[arg(long, value_name = "DIR")]
    pub(super) out: PathBuf,

    /// The frame that has targets. Default: the file's tip_link; for a robot the end of the longest
    /// chain, for a rig all pinned tips (ik_constraints).
    #[arg(long, value_name = "FRAME")]
    pub(super) tip: Option<String>,

    /// Targets of one frame from a JSON file, as for `kinopt solve`. Default: --problems.
    #[arg(long, value_name = "FILE")]
    pub(super) targets: Option<PathBuf>,

    /// Problems drawn at random that have an answer: the tips' places in random configurations.
    /// Default: random:100.
    #[arg(long, value_name = "random:N", value_parser = random, conflicts_with = "targets")]
    pub(super) problems: Option<usize>,

    /// Where searches start. Default: the file's starts; random for robots, rest for rigs.
    #[arg(long, value_name = "rest|random", value_enum)]
    pub(super) start: Option<StartAt>,

    /// Positions alone count, also on robots. Default: off; of rigs only positions count.
    #[arg(long)]
    pub(super) position_only: bool,

    /// What counts as solved: this share of the model's size, and as many radians.
    #[arg(long, value_name = "T", default_value_t = 1e-6, value_parser = number_list::positive)]
    pub(super) tolerance: f64,

    /// Milliseconds that a solver has for one problem; what takes a tenth longer counts as missed.
    #[arg(long, value_name = "MS", default_value = "100",
          value_parser = number_list::milliseconds)]
    pub(super) time_limit: Duration,

    /// How many starts a solver without restarts of its own may try: the problem's own, then random
    /// ones, the same for all.
    #[arg(long, value_name = "N", default_value_t = 16,
          value_parser = clap::value_parser!(u16).range(1..))]
    pub(super) attempts: u16,

    /// Seed of everything random: a whole number.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(super) rng_seed: u64,

    /// Ask this solver only; repeat it for several. Default: all.
    #[arg(long = "solver", value_name = "NAME", value_parser = solver)]
    pub(super) solvers: Vec<String>,

    /// The problem, counted from 0, whose cost is drawn over the steps.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(super) problem: usize,

    /// Measure one Jacobian on chains of up to so many bones; 0 for none.
    #[arg(long, value_name = "N", default_value_t = 256)]
    pub(super) bones: usize,

    #[command(flatten)]
    pub(super) model_options: ModelOptions,
}

/// `--start`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum StartAt {
    /// All zeros, moved into the limits
    Rest,
    /// Another random configuration for each problem
    Random,
}

impl Arguments {
    /// What each solver may spend on one problem.
    pub(super) fn budget(&self) -> Budget {
        Budget {
            time_limit: self.time_limit,
            attempts: usize::from(self.attempts),
        }
    }

    /// Whether a solver takes part.
    pub(super) fn wants(&self, solver: &str) -> bool {
        self.solvers.is_empty() || self.solvers.iter().any(|wanted| wanted == solver)
    }
}

fn solver(text: &str) -> Result<String, String> {
    let all = contenders::all();
    let names: Vec<&str> = all.iter().map(|one| one.name()).collect();
    if names.contains(&text) {
        return Ok(text.to_owned());
    }
    Err(format!("the solvers are: {}", names.join(", ")))
}

fn random(text: &str) -> Result<usize, String> {
    let count = text.strip_prefix("random:").map(str::parse);
    match count {
        Some(Ok(count)) if (1..=1_000_000).contains(&count) => Ok(count),
        _ => Err("expected random:N with N from 1 to 1000000".to_owned()),
    }
}
