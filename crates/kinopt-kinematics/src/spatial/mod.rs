//! Vectors, rotations and rigid placements over any [`Scalar`](crate::Scalar).
//!
//! The inner loops use these types, so every operation is inlined and free of branches. Public interfaces accept
//! nalgebra's types with plain `f64` values; the `conversions` module converts them.

mod conversions;
mod matrix;
mod placement;
mod polar;
mod rigid_defect;
mod rotation;
#[doc(hidden)]
pub mod rounding;
mod vector;

pub use conversions::NotRigid;
pub use matrix::Matrix3;
pub use placement::Placement;
#[doc(hidden)]
pub use polar::Polar;
pub use rigid_defect::RigidDefect;
pub use rotation::{
    Quaternion, rotation_exp, rotation_exp_jacobian, rotation_log, rotation_log_jacobian,
};
#[doc(hidden)]
pub use rounding::{resolved, rounding};
pub use vector::Vector3;
