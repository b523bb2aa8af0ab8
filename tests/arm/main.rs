//! Promises of kinopt-arm: poses, batches, Cartesian paths, servos and collision avoidance.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod any_chain;
mod avoidance;
mod default_start;
mod derivatives;
mod elbow_branches;
mod flipped_axes;
mod huge_numbers;
mod jacobian;
mod jumps;
mod mimic_chains;
mod misses;
mod near_misses;
mod null_space;
mod options;
mod paths;
mod reference_workloads;
mod reproducibility;
mod reused_arms;
mod reversed_chains;
mod searches;
mod servo;
mod servo_cycles;
mod servo_limits;
mod shipped_robots;
mod simd;
mod small_steps;
mod starts;
mod time_limit;
mod track_continuity;
mod two_tips;
mod unreachable;
mod unreachable_lines;
mod whole_turns;
mod winning_attempts;
mod with_tool;
