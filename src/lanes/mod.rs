//! Pose inverse kinematics of serial chains, several attempts or queries at once in SIMD lanes.
//!
//! [`PoseSolver`] is built once from a [`Chain`] and solves single poses, batches and paths by
//! Levenberg-Marquardt over [`Lanes`](lane::Lanes): four or eight problems in lock step, with AVX2
//! and FMA where the processor has them. Attempts begin from the start, from a seed atlas and from
//! random configurations, each known by its number, so that the same question has the same answer.

// Loops over lanes and joints by index: the shape that the vectoriser recognises.
#![allow(clippy::needless_range_loop)]

mod atlas;
mod axis_goal;
mod axis_residual;
mod batch;
mod carry;
mod chain;
mod check;
mod evaluation;
mod group;
mod instruction_set;
mod jacobian;
mod judge;
pub mod lane;
mod ldlt;
mod links;
mod lm_step;
mod options;
mod pose;
mod pose_solver;
mod prepared;
mod query;
mod seeds;
#[cfg(feature = "collision")]
mod seeds_about;
mod settings;
mod single_query;
mod stages;
pub mod trigonometry;
mod twists;
mod whole_turns;

pub use crate::model::JointKind;
pub use axis_goal::AxisGoal;
pub(crate) use batch::{Attempts, Work};
pub use chain::{Chain, ChainError, ChainJoint, MAX_JOINTS};
#[cfg(feature = "collision")]
pub(crate) use links::Links;
pub use options::{LaneError, LaneOptions, PoseOutcome, Prefer};
pub use pose_solver::PoseSolver;
pub(crate) use query::{Answer, Query};
pub(crate) use whole_turns::turned_towards;
