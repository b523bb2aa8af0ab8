//! Promises of `kinopt bench` and of the pictures of `kinopt skin-report`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[macro_use]
#[path = "../command/forked_rig.rs"]
#[allow(dead_code, unused_macros)] // The tests of the command use the rest.
mod forked_rig;

mod skin_report_picture;
mod solvers_compared;
