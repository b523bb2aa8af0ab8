//! Models whose joints close loops.
#![allow(clippy::unwrap_used, clippy::panic)]

mod drags;
mod drawn_configurations;
mod four_bars;
mod grippers;
mod knees;
mod mechanisms;
mod minima;
mod nearest_assemblies;
mod stewart_platforms;
mod truth;
mod two_hands;
mod wrong_loops;
