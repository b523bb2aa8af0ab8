//! Models of joints, their kinematics, and skeletons.
//!
//! Depend on [`kinopt`](https://docs.rs/kinopt), which re-exports this crate. Hidden items may change in any version.

#![warn(clippy::disallowed_methods)]
// On docs.rs every item shows the feature it needs.
#![cfg_attr(docsrs, feature(doc_cfg))]

#[doc(hidden)]
pub mod bad_option;
#[doc(hidden)]
pub mod bisection;
#[doc(hidden)]
pub mod buffer;
pub mod clock;
pub mod curve;
#[doc(hidden)]
pub mod file;
#[doc(hidden)]
pub mod file_access;
#[doc(hidden)]
pub mod file_replacement;
pub mod interruption;
pub mod kinematics;
pub mod model;
#[doc(hidden)]
pub mod plural;
#[doc(hidden)]
pub mod processor;
#[doc(hidden)]
pub mod random;
pub mod scalar;
mod scoped_cell;
mod size_mismatch;
pub mod skeleton;
pub mod spatial;
mod trajectory;

pub use bad_option::BadOption;
pub use buffer::Buffer;
pub use model::Model;
#[cfg(feature = "num-dual")]
#[doc(hidden)] // For the facade.
pub use num_dual;
pub use scalar::Scalar;
pub use size_mismatch::SizeMismatch;
pub use skeleton::Skeleton;
pub use trajectory::Trajectory;
