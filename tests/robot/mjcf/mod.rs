//! MJCF robots.

mod couplings_and_loops;
mod includes;
mod joints;
mod malformed;
mod masses;
mod mujoco;
mod mutations;
mod names;
