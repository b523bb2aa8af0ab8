//! Shapes, distances and worlds.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod certificates;
mod collision_models;
mod mesh_files;
mod shapes;
mod sphere_covers;
