//! Trajectories and paths: Cartesian paths, clips, retargeting and contact detection.

pub mod clip_ik;
mod contact_detection;
pub mod path;
pub mod retarget;
pub mod trajectory;

pub use contact_detection::ContactDetection;
