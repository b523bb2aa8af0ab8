//! Inverse kinematics by optimisation.

pub mod io;
pub mod mesh;
pub mod scalar;
pub mod skinning;
pub mod spatial;

pub use scalar::Scalar;
