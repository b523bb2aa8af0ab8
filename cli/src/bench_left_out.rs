//! `kinopt bench` in builds without the feature.

use std::ffi::OsString;

use clap::Args;

use crate::failure::Outcome;

/// Compare solvers; needs a build with the feature `bench`.
///
/// cargo run --release -p kinopt-cli --features bench -- bench robot.urdf --out results
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// All arguments; ignored.
    #[arg(hide = true, allow_hyphen_values = true, trailing_var_arg = true)]
    rest: Vec<OsString>,
}

pub(crate) fn run(arguments: &Arguments, _json: bool) -> Outcome<()> {
    let words: Vec<_> = arguments
        .rest
        .iter()
        .map(|word| word.to_string_lossy())
        .collect();
    Err(failure!(
        "bench needs a build with the feature `bench`: \
         cargo run --release -p kinopt-cli --features bench -- bench {}",
        words.join(" ")
    ))
}
