//! Minima found by other programs.

mod minima;
mod problems;
