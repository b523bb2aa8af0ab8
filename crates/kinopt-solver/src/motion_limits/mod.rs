//! Motion of joints within limits of position, velocity, acceleration and jerk, shared by servos and drags.

mod goal_motion;
mod joint_motion;

#[doc(hidden)]
pub use goal_motion::GoalHistory;
#[doc(hidden)]
pub use joint_motion::{CycleLimits, GoalMotion, JointMotion};
