//! Clip edits: baking, key reduction, root motion and loop seams.

mod baked;
mod fewer_keys;
mod loop_seam;
mod root_motion;

pub use fewer_keys::KeyTolerance;
pub use root_motion::RootMotion;
