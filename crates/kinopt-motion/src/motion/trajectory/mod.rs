//! Trajectory optimisation: all samples of a motion solved as one problem.
//!
//! The problem has tasks, smoothness costs, hard limits of position and velocity, and contacts. Identifiers call the
//! samples of a trajectory frames.

mod barrier;
mod block_banded;
mod bounds;
mod builder;
mod contact_springs;
mod error;
mod evaluator;
mod feasible_start;
mod fixed_frames;
mod frame_residuals;
mod interior_point;
mod length_bounds;
mod length_limits;
mod motion_problem;
mod motion_report;
mod motion_solver;
mod per_frame;
mod rate_cost;
mod space;
mod step_limits;
mod stretch;

pub use super::contact::Contact;
pub use builder::MotionProblemBuilder;
pub use error::MotionError;
pub use motion_problem::MotionProblem;
pub use motion_report::{
    MotionBound, MotionCounts, MotionLimit, MotionMiss, MotionReport, MotionTermination,
};
pub use motion_solver::{MotionSolver, Windows};
pub use rate_cost::RateCost;
pub(super) use step_limits::step_limits;
