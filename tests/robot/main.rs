//! Promises of kinopt-robot: URDF, MJCF and SRDF files.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod mjcf;
mod srdf;
mod urdf;
