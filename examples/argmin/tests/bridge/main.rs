//! argmin's solvers and executor.

mod bent_arm;
mod in_the_way;
mod promises;
