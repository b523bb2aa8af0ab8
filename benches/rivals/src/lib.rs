//! Common code of the comparison and its helper processes.

mod judge;
mod objective;
mod restart;
pub mod rival;
mod table;
mod workload;

pub use judge::Judge;
pub use objective::Objective;
pub use restart::{Limits, until_deadline};
pub use table::{Row, print};
pub use workload::{Query, Workload};

/// Tolerance of the tip, metres and radians.
pub const TOLERANCE: f64 = 1e-6;

/// Any error before the first query.
pub type Failure = Box<dyn std::error::Error>;
