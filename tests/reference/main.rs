//! Results of programs that share no code with kinopt.

mod interpolation;
mod kinematics;
mod minima;
mod problems;
mod skinning;
