//! Arms: single poses, batches, paths, followers and servos.

mod all_solutions;
#[allow(clippy::module_inception, reason = "it is the arm itself")]
mod arm;
mod batch;
mod derivative;
mod follower;
mod goal_set;
mod reach_map;
mod reachability;
mod servo;
mod several_arms;

pub(crate) use all_solutions::{AllSolutions, SelfMotion};
pub(crate) use arm::Arm;
pub(crate) use batch::Batch;
pub(crate) use derivative::ArmDerivative;
pub(crate) use follower::Follower;
pub(crate) use goal_set::GoalSetSolution;
pub(crate) use reach_map::{BasePlacement, ReachMap};
pub(crate) use reachability::Reachability;
pub(crate) use servo::{Servo, ServoStep};
pub(crate) use several_arms::solve_goals;
