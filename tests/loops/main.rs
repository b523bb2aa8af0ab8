//! Models whose joints close loops.
#![allow(clippy::unwrap_used, clippy::panic)]

mod four_bars;
mod mechanisms;
mod truth;
mod wrong_loops;
