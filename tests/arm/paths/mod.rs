//! Cartesian paths of arms and their times.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod bounds;
mod collisions;
mod cyclic_paths;
mod entries;
mod files;
mod from_start;
mod joint_paths;
mod malformed;
mod reconfigurations;
mod reports;
mod sparse_waypoints;
mod times;
mod trajectories;
mod traversals;
mod unreached_points;
