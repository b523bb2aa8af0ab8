//! Whole motions: many frames solved as one, and Cartesian paths of arms.
#![allow(clippy::unwrap_used, clippy::panic)]

mod bad_captures;
mod bad_motions;
mod clip_ik;
mod clip_minima;
mod contacts;
mod figure_targets;
mod guessed_maps;
mod keyframe_ik;
mod live_followers;
mod path_bounds;
mod path_courses;
mod path_files;
mod path_malformed;
mod path_misses;
mod path_reconfigurations;
mod path_times;
mod path_world;
mod paths_of_joints;
mod retargeted_clear;
mod retargeted_feet;
mod retargeting;
mod shipped_capture;
mod turning_bodies;
mod walker;
mod windows;
