//! Robots from URDF.

mod base_joints;
mod joint_limits;
mod joints;
mod kinematics;
mod lenient;
mod links;
mod malformed;
mod mimic;
mod mutations;
mod real_files;
mod robot_subsets;
mod shipped_tables;
mod soft_limits;
mod soles;
mod systematic_damage;
mod velocity_limits;
