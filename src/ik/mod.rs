//! Solving a [`Problem`](crate::Problem): a method, restarts, and the truth about the result.

mod drag;
mod engine;
mod holding;
mod refine;
mod settle;
mod solver;
mod workspace;

pub use crate::search::{
    ActiveLimit, BoundKind, Restarts, RowsReport, Side, Solution, SolveError, TaskReport,
};
pub use drag::{Drag, Leap};
pub(crate) use engine::Minimiser;
pub use solver::Solver;
pub use workspace::Workspace;
