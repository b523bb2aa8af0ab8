//! Promises of kinopt-mesh: triangle meshes and their files.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod malformed_meshes_and_tables;
mod mesh_file_round_trips;
mod triangle_mesh;
