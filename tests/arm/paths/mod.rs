//! Cartesian paths of arms and their times.

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
mod segments;
mod sparse_waypoints;
mod times;
mod trajectories;
mod traversals;
mod unreached_points;
