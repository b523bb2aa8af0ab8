//! The SIMD solver on its own.

mod arithmetic;
mod best_attempts;
mod bounds;
mod determinism;
mod entry_points;
mod errors;
mod joint_zeros;
mod rail_mounts;
mod reachable_poses;
mod unit_of_length;
mod unreachable;
