//! Robot arms: joint values from a base, a tip and a target.
//!
//! An [`Arm`] is built once from a [`Model`](kinopt_kinematics::Model) or a [`Robot`](kinopt_robot::robot::Robot) and solves for poses of
//! its tool with the SIMD solver ([`lanes`](crate::simd_ik)). Chains that this solver does not support, such as those
//! with mimic joints, use the general [`Problem`](kinopt_solver::Problem). Both have the same API and results.
//!
//! ```
//! # std::env::set_current_dir("../..")?;
//! use kinopt::arm::{Arm, Search};
//! use kinopt::robot::Robot;
//!
//! let robot = Robot::read("models/franka_panda.urdf")?;
//! let arm = Arm::builder(&robot, "base", "flange")
//!     .with_search(Search::Nearest)
//!     .build()?;
//! let start = [0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8];
//! let target = arm.base_from_tool(&[0.4, -0.2, 0.1, -1.8, 0.2, 1.7, 0.5])?;
//! let solution = arm.solve(target, &start)?;
//! assert!(solution.reached, "{}", solution.explain());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod accepted_solutions;
mod all_solutions;
#[allow(clippy::module_inception, reason = "it is the arm itself")]
mod arm;
mod arm_model;
mod batch;
mod branch;
mod builder;
#[cfg(feature = "collision")]
mod collision_avoidance;
mod construction;
mod continuation;
mod coordinates;
mod default_start;
mod derivative;
mod dispatch;
mod distances;
mod error;
mod fallback;
mod follower;
mod following;
mod general_solver;
mod goal_set;
mod joint_path;
mod kinematic_path;
mod local_descent;
mod move_bounds;
mod multi_solution;
mod null_space;
mod options;
mod pose_problem;
mod query;
mod rate_limits;
mod reach_map;
mod reachability;
mod recording;
mod redundancy;
mod revolutions;
mod seed_table;
mod serial_chain;
mod servo;
mod singularity_branch;
mod solve;
mod solve_query;
mod step_subdivision;
mod toward_posture;
mod track;
mod workspace;

pub use crate::simd_ik::PoseOutcome;
pub use all_solutions::{
    AllSolutions, Argument, ArmBranch, ElbowBranch, PoseSolution, SelfMotion, ShoulderBranch,
    WristBranch,
};
pub use arm::Arm;
pub use arm_model::ArmModel;
pub use builder::{ArmBuilder, Base};
pub(crate) use continuation::{ChainMotion, Ends};
pub use derivative::ArmDerivative;
pub use error::{ArmError, QueryError};
pub use follower::Follower;
pub use goal_set::{Criterion, GoalOutcome, GoalSet, GoalSetSolution, GoalStatus};
pub use joint_path::JointPath;
pub use kinopt_solver::ik::JointJump;
pub use kinopt_solver::task::{Axis, PoseBounds};
pub use options::Search;
pub use reach_map::{
    ArmFingerprint, BasePlacement, CellReach, PoseReach, ReachMap, ReachMapBuilder, ReachMapData,
    ReachMapError,
};
pub use reachability::Reachability;
pub use servo::{HeldBy, Servo, ServoStatus, ServoStep};
