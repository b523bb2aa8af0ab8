//! Robots from URDF.

mod joints;
mod kinematics;
mod malformed;
mod mimic;
mod mutations;
mod robot_subsets;
mod shipped_tables;
mod systematic_damage;
mod velocity_limits;
