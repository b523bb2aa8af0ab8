//! Solving for a rig's own keys: between them runs what ran there before.

mod basis;
mod cost;
mod door;
mod interior;

pub use door::{EditedKeys, KeyframeIk};
