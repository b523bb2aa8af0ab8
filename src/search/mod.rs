//! The search that every engine is run by: numbered attempts, which of them counts, and the truth about
//! where it ended.
//!
//! An [`Engine`] searches from one start. [`run`] hands it the starts of a [`Schedule`], the
//! [`Keeper`](best_attempt::Keeper)
//! says which attempt counts and how many agree, and [`Solution::measure`] and
//! [`explain`](Solution::explain) tell what is true of its end.

mod attempt;
mod attempts;
mod basin_hopping;
mod best_attempt;
mod check_start;
mod collisions;
mod error;
mod explain;
mod independent_limbs;
mod measure;
mod move_limits;
#[cfg(feature = "serde")]
pub(crate) mod non_finite;
mod open_loops;
mod out_of_reach;
mod preference_conflicts;
mod restarts;
mod schedule;
mod solution;

pub use crate::problem::{BodyKind, Collision};
pub use crate::solver::Side;
pub(crate) use attempt::{Attempt, Found};
pub(crate) use attempts::{Attempts, Engine, run};
pub(crate) use check_start::{check_start, variables_at};
pub use error::SolveError;
pub(crate) use measure::End;
pub use move_limits::MoveLimits;
pub(crate) use move_limits::{slide_per_radian, within};
pub use open_loops::OpenLoop;
pub(crate) use preference_conflicts::Pulls;
pub use restarts::Restarts;
pub(crate) use schedule::Schedule;
pub use solution::{ActiveLimit, BoundKind, RowsReport, Solution, TaskReport};
