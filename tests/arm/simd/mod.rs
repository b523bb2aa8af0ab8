//! The SIMD solver on its own.

mod arithmetic;
mod bounds;
mod determinism;
mod errors;
mod rail_mounts;
mod reachable_poses;
mod unit_of_length;
