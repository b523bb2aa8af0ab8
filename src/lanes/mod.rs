//! Pose inverse kinematics of serial chains, several attempts or queries at once in SIMD lanes.
//!
//! [`PoseSolver`] is built once from a [`Chain`] and solves single poses, batches and paths by
//! Levenberg-Marquardt over [`Lanes`](lane::Lanes): four or eight problems in lock step, with AVX2
//! and FMA where the processor has them. Attempts begin from the start, from a seed atlas and from
//! random configurations, each known by its number, so that the same question has the same answer.

// Loops over lanes and joints by index: the shape that the vectoriser recognises.
#![allow(clippy::needless_range_loop)]

mod atlas;
mod axes;
mod batch;
mod chain;
mod check;
mod dispatch;
mod errors;
mod evaluation;
mod goal;
mod group;
mod jacobian;
mod judge;
mod kernel;
pub mod lane;
mod ldlt;
mod links;
mod options;
mod pose;
mod prepared;
mod query;
mod race;
mod seeds;
mod settings;
mod solver;
mod stages;
pub mod trigonometry;
mod turns;
mod twists;

pub use chain::{Chain, ChainError, ChainJoint, JointKind, MAX_JOINTS};
pub use goal::AxisGoal;
pub use options::{LaneError, LaneOptions, Outcome, Search};
pub(crate) use query::{Answer, Query};
pub use solver::PoseSolver;
pub(crate) use turns::reduced;
