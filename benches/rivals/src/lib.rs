//! What the comparison and its helper processes share.

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

/// How far the tip may be from its target, metres, and turned from it, radians.
pub const TOLERANCE: f64 = 1e-6;

/// Anything that can go wrong before the first query.
pub type Failure = Box<dyn std::error::Error>;
