//! Memory allocations of solvers and arms.

mod arm;
mod solver;
