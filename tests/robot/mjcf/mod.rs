//! MJCF robots.

mod couplings_and_loops;
mod includes;
mod invalid_values;
mod joints;
mod malformed;
mod masses;
mod mujoco;
mod names;
