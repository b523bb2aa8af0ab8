//! Solving a [`Problem`](crate::Problem): a method, restarts, and the truth about the result.

mod attempts;
mod error;
mod explain;
mod restarts;
mod solution;
mod solver;
mod workspace;

pub use error::SolveError;
pub use restarts::Restarts;
pub use solution::{ActiveLimit, RowsReport, Side, Solution, TaskReport};
pub use solver::Solver;
pub(crate) use solver::check_start;
pub use workspace::Workspace;
