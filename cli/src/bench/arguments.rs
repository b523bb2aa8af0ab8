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
        every solver with every derivative mode, on 100 random reachable poses
  kinopt bench robot.urdf --targets poses.json --out results
        targets of a file
  kinopt bench man.json --solver 'kinopt default' --solver 'argmin L-BFGS' --out results
        two solvers on the pinned tips of a rig

Ctrl-C stops the comparison and writes the finished part.";

/// Compare all solvers, with all derivative modes, on the same problems.
///
/// Writes results.json, results.md and SVG charts. The charts are a performance profile, the solved fraction over time,
/// derivative modes, the cost over iterations, and the Jacobian cost by number of bones. Solutions are checked by
/// forward kinematics and joint limits. Results are reproducible for a seed if no time limit ends a search.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// Model file: robot .urdf or MJCF .xml, or rig .json.
    #[arg(value_name = "MODEL")]
    pub(super) model: PathBuf,

    /// Output folder; created if missing.
    #[arg(long, value_name = "DIR")]
    pub(super) out: PathBuf,

    /// Frame with targets. Default: tip_link of the file; robots: end of the longest chain; rigs: pinned tips.
    #[arg(long, value_name = "FRAME")]
    pub(super) tip: Option<String>,

    /// JSON file of targets of one frame, as for `kinopt solve`. Default: --problems.
    #[arg(long, value_name = "FILE")]
    pub(super) targets: Option<PathBuf>,

    /// Number of random problems with a solution: tip poses of random configurations. Default: random:100.
    #[arg(long, value_name = "random:N", value_parser = random, conflicts_with = "targets")]
    pub(super) problems: Option<usize>,

    /// Start configurations. Default: those of the file; else random for robots, rest for rigs.
    #[arg(long, value_name = "rest|random", value_enum)]
    pub(super) start: Option<StartAt>,

    /// Ignore orientations. Default: off for robots; always on for rigs.
    #[arg(long)]
    pub(super) position_only: bool,

    /// Tolerance: share of the model's size, and radians.
    #[arg(long, value_name = "T", default_value_t = 1e-6, value_parser = number_list::positive)]
    pub(super) tolerance: f64,

    /// Time limit of a problem in milliseconds; a solve 10 % above it counts as not reached.
    #[arg(long, value_name = "MS", default_value = "100",
          value_parser = number_list::milliseconds)]
    pub(super) time_limit: Duration,

    /// Largest number of starts for solvers without restarts: the problem's, then random ones, equal for all solvers.
    #[arg(long, value_name = "N", default_value_t = 16,
          value_parser = clap::value_parser!(u16).range(1..))]
    pub(super) attempts: u16,

    /// Seed of the random generator, a whole number.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(super) rng_seed: u64,

    /// Solver to compare. Default: all. Repeatable.
    #[arg(long = "solver", value_name = "NAME", value_parser = solver)]
    pub(super) solvers: Vec<String>,

    /// Index of the problem, from 0, in the chart of cost over iterations.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(super) problem: usize,

    /// Largest number of bones in the Jacobian measurement; 0 for none.
    #[arg(long, value_name = "N", default_value_t = 256)]
    pub(super) bones: usize,

    #[command(flatten)]
    pub(super) model_options: ModelOptions,
}

/// Value of `--start`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum StartAt {
    /// All zeros, moved into the limits
    Rest,
    /// A random configuration for each problem
    Random,
}

impl Arguments {
    /// Budget of each solver for one problem.
    pub(super) fn budget(&self) -> Budget {
        Budget {
            time_limit: self.time_limit,
            attempts: usize::from(self.attempts),
        }
    }

    /// True if a solver takes part.
    pub(super) fn wants(&self, solver: &str) -> bool {
        self.solvers.is_empty() || self.solvers.iter().any(|wanted| wanted == solver)
    }
}

fn solver(text: &str) -> Result<String, String> {
    let contenders = contenders::all();
    let names: Vec<&str> = contenders.iter().map(|solver| solver.name()).collect();
    if names.contains(&text) {
        return Ok(text.to_owned());
    }
    Err(format!("unknown solver; solvers: {}", names.join(", ")))
}

fn random(text: &str) -> Result<usize, String> {
    let count = text.strip_prefix("random:").map(str::parse);
    match count {
        Some(Ok(count)) if (1..=1_000_000).contains(&count) => Ok(count),
        _ => Err("expected random:N with N from 1 to 1000000".to_owned()),
    }
}
