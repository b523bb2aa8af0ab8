//! Options of `kinopt reach`: ranking, limits of the proofs, and output.

use std::time::Duration;

use clap::Args;
use kinopt_bindings::problem_file::{ProblemSettings, number_list};

use super::criterion::RankedBy;
use super::table_file::TableFile;
use crate::help_headings::{OUTPUT, SEARCH};
use crate::problem_options::{ProblemOptions, set};

/// Ranking, limits of the proofs, and output.
#[derive(Args, Debug)]
pub(crate) struct ReachOptions {
    /// Rank by distance, manipulability or clearance. Default: distance.
    #[arg(long, value_name = "CRITERION", value_parser = RankedBy::parse, help_heading = SEARCH)]
    pub(super) criterion: Option<RankedBy>,

    /// Largest number of boxes of a proof. Default: 20000.
    #[arg(long, value_name = "N", help_heading = SEARCH)]
    pub(super) max_boxes: Option<u32>,

    /// Number of threads, 1 to 1024. Default: 1.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024),
          help_heading = SEARCH)]
    pub(super) threads: Option<u16>,

    /// Time limit of a search or proof in ms; results then depend on the machine.
    #[arg(long, value_name = "MS", value_parser = number_list::milliseconds, help_heading = SEARCH)]
    time_limit: Option<Duration>,

    /// Write the results to a .csv table or .json.
    #[arg(long, value_name = "FILE", value_parser = TableFile::parse, help_heading = OUTPUT)]
    pub(super) out: Option<TableFile>,
}

impl ProblemOptions for ReachOptions {
    fn add_to(&self, problem: &mut ProblemSettings, _degrees: bool) {
        set(&mut problem.solve.time_limit, self.time_limit.as_ref());
    }
}
