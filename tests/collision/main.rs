//! Shapes, distances and worlds.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod arms_keep_clear;
mod bad_worlds;
mod bodies_keep_clear;
mod certificates;
mod checkers;
mod coal;
mod collision_models;
mod convex_pieces;
mod figures_of_capsules;
mod free_paths_are_followed;
mod free_tracks_are_as_plain;
mod held_objects;
mod hostile;
mod hulls_of_many_corners;
mod identities;
mod mesh_files;
mod mjcf_contacts;
mod narrow_gaps;
mod paths_keep_clear;
mod sampled_pairs;
mod scaled_worlds;
mod shapes;
mod sphere_covers;
mod sphere_files;
mod spheres_change_no_answer;
mod thin_walls;
mod time_limits;
mod tops;
mod ways_that_slide;
mod what_exactly_meets;
mod what_no_joint_moves;
mod world_files;
mod worlds;
mod worlds_that_change;
