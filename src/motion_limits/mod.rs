//! Motion of joints within limits of position, velocity, acceleration and jerk, shared by servos and drags.

mod goal_motion;
mod joint_motion;

pub(crate) use goal_motion::GoalHistory;
pub(crate) use joint_motion::{CycleLimits, GoalMotion, JointMotion};
