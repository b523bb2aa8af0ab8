//! Solving for a rig's own keys: between them runs what ran there before.

mod basis;
mod cost;
mod interior;
mod keyframe_ik;

pub use keyframe_ik::{EditedKeys, KeyframeIk};
