//! Promises of argmin's solvers and executor on kinopt's problems.

mod bent_arm;
mod cones;
mod in_the_way;
mod promises;
mod runs;
