//! Promises of the command, one per module.
//!
//! With the feature `bench` this binary is empty; `tests/bench` covers that feature.
#![cfg(not(feature = "bench"))]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[macro_use]
mod forked_rig;

mod animated_meshes;
mod balance;
mod ball_figures;
mod base_joints;
mod calibrate;
mod character_convergence;
mod check;
mod clip_ik;
mod collision_avoidance;
mod command_page;
mod default_start;
mod derivatives;
mod exit_codes_and_errors;
mod file_access;
mod goal_bounds_and_weights;
mod help_pages;
mod hinges;
mod holds;
mod json_output;
mod locked_joints;
mod loops;
mod many_targets;
mod mjcf;
mod motion_capture;
mod option_tables;
mod pages;
mod path;
mod posed_mesh;
mod priority_levels;
mod problem_files;
mod reach;
mod retarget;
mod retarget_files;
mod retarget_folders;
mod robot_files;
mod robots;
mod scene_clips;
mod scenes;
mod score;
mod seeded_robot;
mod servo;
mod smpl;
mod spheres;
mod task_files;
mod without_features;
