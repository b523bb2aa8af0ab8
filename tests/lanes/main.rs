//! The lane engine alone.

mod arithmetic;
mod bounds;
mod determinism;
mod errors;
mod success;
mod unit_of_length;
mod unreachable;
