//! Pose inverse kinematics of serial chains, several attempts or queries at once in SIMD lanes.

mod atlas;
mod batch;
mod chain;
mod dispatch;
mod judge;
mod kernel;
pub mod lane;
mod links;
mod race;
mod seeds;
mod solver;
pub mod trigonometry;

pub use chain::{Chain, ChainError, ChainJoint, JointKind, MAX_JOINTS};
pub use solver::{LaneOptions, Outcome, PoseSolver, Search};
