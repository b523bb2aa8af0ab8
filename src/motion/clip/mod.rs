//! Trajectory optimisation: all samples of a motion solved as one problem.
//!
//! The problem has tasks, smoothness costs, hard limits of position and velocity, and contacts. Identifiers call the
//! samples of a trajectory frames.

mod barrier;
mod block_banded;
mod bounds;
mod builder;
mod contact;
mod draw_together;
mod error;
mod evaluator;
mod fixed_frames;
mod frame_residuals;
mod held_points;
mod interior_point;
mod length_bounds;
mod length_limits;
mod longest_moves;
mod motion_problem;
mod motion_solver;
mod per_frame;
mod rate_cost;
mod solution;
mod space;

pub use builder::MotionProblemBuilder;
pub use contact::Contact;
pub use error::MotionError;
pub(super) use longest_moves::longest_moves;
pub use motion_problem::MotionProblem;
pub use motion_solver::{MotionSolver, Windows};
pub use rate_cost::RateCost;
pub use solution::{
    MotionBound, MotionCounts, MotionLimit, MotionMiss, MotionSolution, MotionTermination,
};
