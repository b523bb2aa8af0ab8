//! Inverse kinematics by optimisation.

pub mod animation;
pub mod io;
pub mod kinematics;
pub mod mesh;
pub mod model;
pub mod scalar;
pub mod skeleton;
pub mod skinning;
pub mod spatial;

pub use scalar::Scalar;
