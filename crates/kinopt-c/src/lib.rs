//! C interface of kinopt.
//!
//! The header `include/kinopt/kinopt.h` is generated from this crate by cbindgen; `include/kinopt/kinopt.hpp` is a C++17
//! layer with Eigen.
//!
//! - **Units** are metres, radians and seconds.
//! - **Placements** are sixteen numbers: a 4 x 4 matrix by columns, as in Eigen.
//! - **Settings** are JSON objects with the options of the library by name, or null for the defaults:
//!   `{"position_tolerance": 1e-4, "goal": "position"}`. An unknown name is an error that lists the valid ones.
//! - **Errors** are a [`KinoptStatus`]. [`kinopt_error_message`](error::kinopt_error_message) has the text of the last
//!   error of the calling thread. A target that is not reached is no error.
//! - **Objects** belong to the caller, who frees each by its `_free` function, in any order. Null is allowed there.
//! - **Threads**: robots, arms, collision models, problems and joint paths are immutable and shared freely. Worlds, servos,
//!   solutions, solvers, targets and Jacobians are used by one thread at a time. Callbacks run on the calling thread.
//! - No panic and no exception crosses the interface. A callback must not throw.

// Pointers of the caller are read in `pointer.rs` and freed there; every function passes its pointers on.
#![allow(unsafe_code)]
// The conditions on pointers are the same for all functions, and above.
#![allow(clippy::missing_safety_doc)]

pub mod arm;
pub mod batch;
pub mod error;
pub mod jacobian;
pub mod path;
mod pointer;
pub mod problem;
pub mod robot;
pub mod servo;
mod settings;
pub mod solution;
pub mod solver;
pub mod targets;
pub mod trajectory;
pub mod world;

pub use error::KinoptStatus;
