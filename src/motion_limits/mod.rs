//! Motion of joints within limits of position, velocity, acceleration and jerk, shared by servos and drags.

mod goal_motion;
mod joint_motion;

pub(crate) use goal_motion::GoalHistory;
pub(crate) use joint_motion::{CycleLimits, GoalMotion, JointMotion};

/// Share of a limit that is left for rounding that adds up over a stop.
pub(crate) const ROUNDING: f64 = 1e-9;
