//! Promises of `kinopt bench`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[macro_use]
#[path = "../command/forked_rig.rs"]
#[allow(dead_code, unused_macros)] // The tests of the command use the rest.
mod forked_rig;

#[path = "../command/help_pages.rs"]
mod help_pages;
mod solvers_compared;
