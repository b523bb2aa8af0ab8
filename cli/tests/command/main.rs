//! Promises of the command, one per module.
//!
//! With the feature `bench` this binary is empty; `tests/bench` covers that feature.
#![cfg(not(feature = "bench"))]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[macro_use]
mod forked_rig;

mod among_obstacles;
mod animated_meshes;
mod balance;
mod ball_figures;
mod base_joints;
mod check;
mod clip_ik;
mod command_page;
mod default_start;
mod derivatives;
mod exit_codes_and_errors;
mod figures_settle;
mod file_access;
mod held_joints;
mod holds;
mod json_output;
mod loops;
mod many_targets;
mod mjcf;
mod motion_capture;
mod option_tables;
mod pages;
mod path;
mod posed_mesh;
mod retarget;
mod retarget_files;
mod retarget_folders;
mod robot_files;
mod robots;
mod room_and_weights;
mod scene_clips;
mod scenes;
mod seeded_robot;
mod servo;
mod skin_report;
mod spheres;
mod strict_levels;
mod task_files;
mod without_features;
