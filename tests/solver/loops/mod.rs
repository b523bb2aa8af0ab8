//! Models with closed loops.

mod drags;
mod four_bars;
mod grippers;
mod invalid_loops;
mod mechanisms;
mod minima;
mod nearest_assemblies;
mod random_configurations;
mod reported_closures;
mod rod_driven_legs;
mod stewart_platforms;
mod two_hands;
