//! Solving problems of tasks.

mod contradicting_targets;
mod drags;
mod first_steps;
mod invariance;
mod limits_hold;
mod method_battery;
mod not_finite;
mod nudges;
mod overextended_arm;
mod preferences;
mod preferences_at_misses;
mod pulls;
mod reported_errors;
mod restarts;
mod same_bits;
mod singular_rest_poses;
mod small_chains;
mod step_lengths;
mod stopping;
mod success_rate;
mod symmetric_questions;
mod targets_apart;
mod told_misses;
mod traded_preferences;
mod unreachable_targets;
mod which_attempt_counts;
