//! URDF robots.

mod base_joints;
mod foot_contacts;
mod joint_limits;
mod joints;
mod kinematics;
mod lenient;
mod links;
mod malformed;
mod mimic;
mod real_files;
mod robot_subsets;
mod shipped_tables;
mod soft_limits;
mod systematic_damage;
mod velocity_limits;
