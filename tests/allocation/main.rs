//! Memory allocations of solvers and arms.

mod arm;
mod counting_allocator;
mod solver;
