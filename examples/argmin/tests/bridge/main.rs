//! argmin's solvers and executor.

mod bent_arm;
mod promises;
