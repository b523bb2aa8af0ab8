//! Promises of the whole library: its interface, damaged files and memory allocations.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod allocation;
mod counting_allocator;
mod interface;
mod malformed;
