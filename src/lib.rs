//! Inverse kinematics by optimisation.

pub mod kinematics;
pub mod model;
pub mod robot;
pub mod scalar;
pub mod skeleton;
pub mod spatial;

pub use scalar::Scalar;
