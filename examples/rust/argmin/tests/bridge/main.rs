//! Promises of argmin's solvers and executor on kinopt's problems.

mod bent_arm;
mod cones;
mod obstacles;
mod promises;
mod runs;
