//! Pose inverse kinematics of serial chains in SIMD lanes.
//!
//! [`PoseSolver`] is built once from a [`Chain`] and solves single poses, batches and paths by Levenberg-Marquardt. Up
//! to eight attempts or queries run in lock step over [`Lanes`](lane::Lanes), with AVX2 and FMA if the processor has
//! them. Attempts begin at the given start, at configurations of a seed atlas, and at random ones. The number of an
//! attempt determines its start, so equal queries give equal results.

// Index loops over lanes and joints: the form that the vectoriser recognises.
#![allow(clippy::needless_range_loop)]

mod atlas;
mod axis_goal;
mod axis_residual;
mod batch;
mod chain;
mod check;
mod continue_starts;
mod evaluation;
mod group;
mod instruction_set;
mod jacobian;
mod judge;
pub mod lane;
mod ldlt;
mod links;
mod lm_step;
#[cfg(feature = "collision")]
mod neighbour_seeds;
mod options;
mod pose;
mod pose_solver;
mod prepared;
mod query;
mod revolutions;
mod seeds;
mod settings;
mod single_query;
mod stages;
pub mod trigonometry;
mod twists;

pub use axis_goal::AxisGoal;
pub(crate) use batch::{Attempts, Work};
pub use chain::{Chain, ChainJoint, MAX_JOINTS};
pub use kinopt_kinematics::model::JointKind;
#[cfg(feature = "collision")]
pub(crate) use links::Links;
pub use options::{LaneError, LaneOptions, PoseOutcome, Prefer};
pub use pose_solver::PoseSolver;
pub(crate) use query::{Query, QueryOutput};
pub(crate) use revolutions::nearest_revolution;
