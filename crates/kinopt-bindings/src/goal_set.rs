//! Names of goal sets: criteria, and results of goals.

use kinopt::arm::{Criterion, GoalStatus};
use kinopt::model::UnknownName;

/// Clearances beyond this distance count as equal, metres.
#[cfg(feature = "collision")]
pub const MAX_CLEARANCE: f64 = 0.5;

/// Criterion of a name.
///
/// # Errors
/// An unknown name; the message lists the valid ones.
pub fn criterion(name: &str) -> Result<Criterion<'static>, UnknownName> {
    match name {
        "distance" => Ok(Criterion::Distance),
        "manipulability" => Ok(Criterion::Manipulability),
        #[cfg(feature = "collision")]
        "clearance" => Ok(Criterion::Clearance {
            max_distance: MAX_CLEARANCE,
        }),
        _ => {
            let names = ["distance", "manipulability"].into_iter();
            #[cfg(feature = "collision")]
            let names = names.chain(["clearance"]);
            Err(UnknownName::new("criterion", name, names))
        }
    }
}

/// Result of a goal in words.
#[must_use]
pub fn status(status: GoalStatus) -> &'static str {
    match status {
        GoalStatus::Reached => "reached",
        GoalStatus::InCollision => "in collision",
        GoalStatus::OutOfReach => "out of reach",
        _ => "missed",
    }
}
