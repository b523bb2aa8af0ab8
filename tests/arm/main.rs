//! Arms: poses, batches, paths and servos.

mod any_chain;
mod default_start;
mod derivatives;
mod elbow_branches;
mod flipped_axes;
mod huge_numbers;
mod jacobian;
mod mimic_chains;
mod null_space;
mod whole_turns;

mod jumps;
mod misses;
mod near_misses;
mod options;
mod peer_defects;
mod reference_workloads;
mod reproducibility;
mod reused_arms;
mod reversed_chains;
mod searches;
mod servo;
mod servo_cycles;
mod servo_limits;
mod shipped_robots;
mod small_steps;
mod starts;
mod time_limit;
mod track_continuity;
mod two_tips;
mod unreachable;
mod unreachable_lines;
mod winning_attempts;
mod with_tool;
