//! Poses, batches and paths of arms.

mod any_chain;
mod bounded_turns;
mod chains_with_followers;
mod default_start;
mod derivatives;
mod elbow_sides;
mod flipped_axes;
mod freedom;
mod huge_numbers;
mod jacobian;

mod jumps;
mod lines_out_of_reach;
mod misses;
mod near_misses;
mod options;
mod peer_defects;
mod retarget;
mod reused_arms;
mod same_bits;
mod searches;
mod servo;
mod servo_limits;
mod servo_ticks;
mod shared_workloads;
mod shipped_robots;
mod small_steps;
mod starts;
mod starts_and_ways;
mod time_limit;
mod tracks_without_flips;
mod two_tips;
mod unreachable;
mod winners;
