//! Inverse kinematics on the existing keys of a rig, with unchanged splines between them.

mod basis;
mod beyond_limit;
mod cost;
mod interior;
mod keyframe_ik;
mod within;

pub use beyond_limit::BeyondLimit;
pub use keyframe_ik::{EditedKeys, KeyframeIk};
