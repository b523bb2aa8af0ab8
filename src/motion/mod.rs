//! Whole motions, above single poses.

pub mod clip;
pub mod path;
pub mod retarget;
