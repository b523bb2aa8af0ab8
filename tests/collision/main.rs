//! Shapes, distances and worlds.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod arms_keep_clear;
mod certificates;
mod checkers;
mod collision_models;
mod mesh_files;
mod shapes;
mod sphere_covers;
