//! argmin's solvers and executor.

mod bent_arm;
mod cones;
mod in_the_way;
mod promises;
mod runs;
