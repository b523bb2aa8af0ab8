//! Inverse kinematics by optimisation.

pub mod lanes;
pub mod scalar;
pub mod spatial;

pub use scalar::Scalar;
