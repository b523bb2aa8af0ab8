//! Arguments of `kinopt bench`.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, ValueEnum};
use kinopt_bindings::problem_file::number_list;
use kinopt_harness::{Budget, contenders};

use crate::model_options::ModelOptions;

const EXAMPLES: &str = "\
Examples:
  kinopt bench robot.urdf --problems random:100 --out results
  kinopt bench robot.urdf --targets poses.json --out results
  kinopt bench man.json --solver 'kinopt default' --solver 'argmin L-BFGS' --out results

Writes results.json, results.md and SVG charts. Ctrl-C stops the comparison and writes the finished
part. Results are reproducible for a seed if no time limit ends a search.";

/// Compare all solvers, with all derivative modes, on the same problems.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// Model file: robot .urdf or MJCF .xml, or rig .json.
    #[arg(value_name = "MODEL")]
    pub(super) model: PathBuf,

    /// Output folder; created if missing.
    #[arg(long, value_name = "DIR")]
    pub(super) out: PathBuf,

    /// Frame with targets. Default: tip_link of the file, else the longest chain.
    #[arg(long, value_name = "FRAME")]
    pub(super) tip: Option<String>,

    /// JSON file of targets, as for `kinopt batch`. Default: --problems.
    #[arg(long, value_name = "FILE")]
    pub(super) targets: Option<PathBuf>,

    /// Number of random reachable problems. Default: random:100.
    #[arg(long, value_name = "random:N", value_parser = random, conflicts_with = "targets")]
    pub(super) problems: Option<usize>,

    /// rest or random. Default: the file's; else random, of rigs rest.
    #[arg(long, value_name = "START", value_enum, hide_possible_values = true)]
    pub(super) start: Option<StartAt>,

    /// Ignore orientations. Default: off for robots; always on for rigs.
    #[arg(long)]
    pub(super) position_only: bool,

    /// Tolerance: share of the model's size, and radians.
    #[arg(long, value_name = "T", default_value_t = 1e-6, value_parser = number_list::positive)]
    pub(super) tolerance: f64,

    /// Time limit of a problem in milliseconds.
    #[arg(long, value_name = "MS", default_value = "100",
          value_parser = number_list::milliseconds)]
    pub(super) time_limit: Duration,

    /// Largest number of starts for solvers without restarts.
    #[arg(long, value_name = "N", default_value_t = 16,
          value_parser = clap::value_parser!(u16).range(1..))]
    pub(super) attempts: u16,

    /// Seed of the random generator, a whole number.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(super) rng_seed: u64,

    /// Solver to compare. Default: all. Repeatable.
    #[arg(long = "solver", value_name = "NAME", value_parser = solver)]
    pub(super) solvers: Vec<String>,

    /// Index of the problem, from 0, in the chart of costs.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(super) charted: usize,

    /// Largest number of bones in the Jacobian measurement.
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
