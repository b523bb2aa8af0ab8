//! Solving for a rig's own keys: between them runs what ran there before.

mod basis;
mod beyond_limit;
mod cost;
mod interior;
mod keyframe_ik;
mod within;

pub use beyond_limit::BeyondLimit;
pub use keyframe_ik::{EditedKeys, KeyframeIk};
