//! The search over attempts, common to all engines.
//!
//! An [`Engine`] searches from one start. [`run`] gives it the starts of a [`Schedule`]. The
//! `Keeper` chooses the best attempt and counts those that agree with it. [`Solution::measure`]
//! measures the errors at its end, and [`explain`](Solution::explain) describes them.

mod attempts;
mod basin_hopping;
mod best_attempt;
mod check_start;
mod collisions;
mod explain;
mod independent_limbs;
mod measure;
mod move_limits;
#[cfg(feature = "serde")]
#[doc(hidden)]
pub mod non_finite;
mod open_loops;
mod out_of_reach;
mod preference_conflicts;
mod restarts;
mod schedule;
mod search_result;
mod solution;

pub use crate::problem::{BodyKind, Collision};
pub use crate::solver::{Side, SolveError};
#[doc(hidden)]
pub use attempts::{Attempts, Engine, run};
#[doc(hidden)]
pub use check_start::{check_start, variables_at};
#[doc(hidden)]
pub use measure::End;
pub use move_limits::MoveLimits;
#[doc(hidden)]
pub use move_limits::{slide_per_radian, within};
pub use open_loops::OpenLoop;
pub(crate) use preference_conflicts::PreferenceConflict;
pub use restarts::Restarts;
#[doc(hidden)]
pub use schedule::Schedule;
#[doc(hidden)]
pub use search_result::SearchResult;
pub use solution::{ActiveLimit, BoundKind, RowBlockReport, Solution, TaskReport};
