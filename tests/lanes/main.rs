//! The lane engine alone.

mod arithmetic;
mod arms_on_rails;
mod bounds;
mod determinism;
mod doors;
mod errors;
mod misses;
mod success;
mod turned_zeros;
mod unit_of_length;
mod unreachable;
