//! Promises of the whole library: its interface, damaged files and memory allocations.

mod allocation;
mod counting_allocator;
mod interface;
mod malformed;
