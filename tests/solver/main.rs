//! Solving problems of tasks.

mod contradicting_targets;
mod drags;
mod invariance;
mod limits_hold;
mod method_battery;
mod not_finite;
mod overextended_arm;
mod preferences;
mod reported_errors;
mod restarts;
mod same_bits;
mod send_and_sync;
mod singular_rest_poses;
mod small_chains;
mod step_lengths;
mod stopping;
mod success_rate;
mod unreachable_targets;
