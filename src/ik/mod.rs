//! Solving a [`Problem`](crate::Problem): a method, restarts, and the truth about the result.

mod attempts;
mod drag;
mod error;
mod explain;
mod holding;
mod pulling;
mod reach;
mod refine;
mod restarts;
mod settle;
mod solution;
mod solver;
mod workspace;

pub use drag::{Drag, Leap};
pub use error::SolveError;
pub use restarts::Restarts;
pub use solution::{ActiveLimit, BoundKind, RowsReport, Side, Solution, TaskReport};
pub use solver::Solver;
pub(crate) use solver::check_start;
pub use workspace::Workspace;
