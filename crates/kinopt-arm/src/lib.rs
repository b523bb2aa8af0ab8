//! Inverse kinematics of robot arms: poses, batches, servo and Cartesian paths.
//!
//! Depend on [`kinopt`](https://docs.rs/kinopt), which re-exports this crate. Hidden items may change in any version.

#![warn(clippy::disallowed_methods)]
// On docs.rs every item shows the feature it needs.
#![cfg_attr(docsrs, feature(doc_cfg))]

pub mod arm;
pub mod calibration;
pub mod path;
#[doc(hidden)]
pub mod simd_ik;
#[cfg(feature = "collision")]
mod simd_spheres;

pub use arm::Arm;
