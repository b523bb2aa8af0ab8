//! Inverse kinematics by optimisation.

pub mod animation;
#[cfg(feature = "argmin")]
pub mod argmin_bridge;
pub mod arm;
pub mod ik;
pub mod io;
pub mod kinematics;
pub mod lanes;
pub mod mesh;
pub mod model;
pub mod problem;
mod random;
pub mod robot;
pub mod scalar;
pub mod skeleton;
pub mod skinning;
pub mod solver;
pub mod spatial;
pub mod task;

pub use arm::Arm;
pub use ik::{Solution, Solver, Workspace};
pub use model::Model;
pub use problem::Problem;
pub use scalar::Scalar;
pub use skeleton::Skeleton;
