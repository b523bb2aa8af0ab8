//! Tasks, problems, and the solvers of bounded nonlinear least squares.
//!
//! Depend on [`kinopt`](https://docs.rs/kinopt), which re-exports this crate. Hidden items may change in any version.

#![warn(clippy::disallowed_methods)]
// On docs.rs every item shows the feature it needs.
#![cfg_attr(docsrs, feature(doc_cfg))]

pub mod geometric;
pub mod ik;
#[doc(hidden)]
pub mod motion_limits;
pub mod problem;
#[doc(hidden)]
pub mod search;
pub mod solver;
pub mod task;

pub use ik::{Solution, Solver, Workspace};
pub use problem::Problem;
