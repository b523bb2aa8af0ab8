//! Promises of the whole interface: traits of public types, and a single policy for invalid input.

mod crate_graph;
mod interruptions;
mod invalid_numbers;
mod joint_kinds;
mod option_tables;
mod public_types;
mod serialised;
