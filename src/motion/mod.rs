//! Whole motions, above single poses.

pub mod clip;
mod contact_detection;
pub mod path;
pub mod retarget;

pub use contact_detection::ContactDetection;
