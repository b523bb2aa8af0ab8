//! Promises of kinopt-kinematics: rotations, placements, models, forward kinematics and Jacobians.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod ball_limits;
mod canonical_bones;
mod centre_of_mass;
mod configurations;
mod forward_kinematics;
mod frame_jacobians;
mod kinematic_jacobian;
mod model_reach;
mod parameter_maps;
mod placed_skeletons;
mod placement_conversions;
mod planar_joints;
mod random_configurations;
mod reference;
mod rotation_exp_log;
mod scalar_functions;
mod skeleton_poses;
mod unknown_names;
