//! Promises of the whole interface: what all public types can do, and one policy for wrong input.

mod interruptions;
mod joint_kinds;
mod option_tables;
mod public_types;
mod serialised;
mod wrong_numbers;
